#pragma once
// The selected vertices of pages on their way into an answer.

#include <algorithm>
#include <memory_resource>
#include <span>
#include <vector>

#include "engine/large_memory.hpp"
#include "query/kept_heights.hpp"

namespace talus {

/// What a tolerance selects, exactly: errors that pages imply are on no ladder.
class Above {
 public:
  /// `tolerance_m` without what stored heights may be off.
  Above(double tolerance_m, const CodeDistance& distance);

  /// Of sample i of a page: false for those that are no vertices of its own.
  [[nodiscard]] bool operator()(const Page& page, std::size_t i) const {
    if (page.errors[i] > code_) return true;
    if (!page.eighths.empty()) return page.eighths[i] > eighths_;
    return !page.distances.empty() && page.distances[i] > distance_;
  }
  /// Whether a page with this largest error may hold one.
  [[nodiscard]] bool operator()(ErrorCode largest) const { return largest > code_; }

  [[nodiscard]] ErrorCode code() const { return code_; }
  [[nodiscard]] std::int32_t eighths() const { return eighths_; }  ///< of a height code, -1: none is small enough
  [[nodiscard]] double distance() const { return distance_; }      ///< in height codes

 private:
  ErrorCode code_;
  double distance_;
  std::int32_t eighths_;
};

struct LargestErrors {
  ErrorCode code = 0;
  std::int32_t eighths = -1;
};
/// Of a stretch of a page's samples, many at once.
[[nodiscard]] LargestErrors largest_errors(std::span<const ErrorCode> codes, std::span<const std::int32_t> eighths);

/// The largest error that an answer leaves out.
struct LargestAbsent {
  ErrorCode code = 0;
  double distance = -1;  ///< in height codes, of those that are implied; -1: none

  void take(const Page& page, std::size_t i) {
    if (page.is_implied(i)) {
      distance = std::max(distance, page.implied_distance(i));
    } else {
      code = std::max(code, page.errors[i]);
    }
  }
  void take(const LargestAbsent& others) {
    code = std::max(code, others.code);
    distance = std::max(distance, others.distance);
  }
};

/// RestrictedQuadtree::level_errors in the making.
class LargestByLevel {
 public:
  explicit LargestByLevel(GridRect extent);
  void take(const Page& page, std::size_t i, GridPoint p) {
    LargestAbsent& level = levels_[std::min<std::size_t>(static_cast<std::size_t>(height_in_tree(p)), levels_.size() - 1)];
    level.take(page, i);
  }
  void take(const LargestByLevel& others);
  [[nodiscard]] std::vector<double> metres(const StoredPages& pages) const;

 private:
  std::vector<LargestAbsent> levels_;  ///< none of them absent; by log2 of the spacing
};

/// A sample of a page, by its place there.
struct PageSample {
  std::uint16_t col, row;
};

/// Collects vertices page by page, then makes a quadtree of them.
class FoundVertices {
 public:
  /// expected_bytes  of what is found, sixteen a vertex; more is found room for
  FoundVertices(const StoredPages& pages, QueryCost& cost, std::size_t expected_bytes = std::size_t{1} << 16)
      : pages_(pages), cost_(cost), kept_(pages, cost), memory_(expected_bytes, &large_) {}
  FoundVertices(const FoundVertices&) = delete;
  FoundVertices& operator=(const FoundVertices&) = delete;

  void begin_page() { pages_found_.emplace_back(&memory_); }
  /// An own vertex of the page that was begun.
  void take(const Page& page, std::int32_t col, std::int32_t row) {
    OfPage& here = pages_found_.back();
    const GridPoint p = page.grid.at(col, row);
    const std::size_t i = page.index(col, row);
    here.at.push_back(p);
    here.heights.push_back(kept_.is_kept(page, col, row) ? page.heights[i] : kept_.at(p));
    if (!page.covers.empty()) here.covers.push_back(page.covers[i]);
  }
  /// All that are taken of a page.
  void take(const Page& page, std::span<const PageSample> samples);

  /// `vertices` must hold those taken and none else but such as nothing needs: their pages are not stored.
  [[nodiscard]] RestrictedQuadtree quadtree(GridRect region, VertexMask vertices) const;
  /// Of what several have found.
  [[nodiscard]] static RestrictedQuadtree quadtree(std::span<const FoundVertices* const> parts, GridRect region,
                                                   VertexMask vertices, int threads);

 private:
  struct OfPage {
    explicit OfPage(std::pmr::memory_resource* memory) : at(memory), heights(memory), covers(memory) {}
    std::pmr::vector<GridPoint> at;
    std::pmr::vector<double> heights;
    std::pmr::vector<std::uint8_t> covers;  ///< empty: all 15
  };

  [[nodiscard]] bool is_height(double code) const;
  const StoredPages& pages_;
  QueryCost& cost_;
  KeptHeights kept_;
  LargePages large_;
  std::pmr::monotonic_buffer_resource memory_;
  std::vector<OfPage> pages_found_;
};

/// No sample under a surface without these vertices is farther from it.
///
/// tolerance_m  what the absent ones were held against; infinite where it varied
[[nodiscard]] Metres bound_of(const StoredPages& pages, const LargestAbsent& absent, double tolerance_m);

}  // namespace talus
