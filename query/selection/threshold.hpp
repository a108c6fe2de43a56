#pragma once
// What a tolerance selects of a page's vertices, and what the vertices that it leaves out make of the bound.

#include <algorithm>
#include <span>
#include <vector>

#include "engine/page/page_codec.hpp"
#include "query/pages/stored_pages.hpp"

namespace talus {

/// What a tolerance selects, exactly: errors that pages imply are on no ladder.
class Threshold {
 public:
  /// `tolerance_m` without what stored heights may be off.
  Threshold(double tolerance_m, const CodeDistance& distance);

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
    LargestAbsent& level =
        levels_[std::min<std::size_t>(static_cast<std::size_t>(height_in_tree(p)), levels_.size() - 1)];
    level.take(page, i);
  }
  void take(const LargestByLevel& others);
  [[nodiscard]] std::vector<double> metres(const StoredPages& pages) const;

 private:
  std::vector<LargestAbsent> levels_;  ///< none of them absent; by log2 of the spacing
};

/// No sample under a surface without these vertices is farther from it.
///
/// tolerance_m  what the absent ones were held against; infinite where it varied
[[nodiscard]] Metres bound_of(const StoredPages& pages, const LargestAbsent& absent, double tolerance_m);

}  // namespace talus
