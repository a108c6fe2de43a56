#pragma once
// Collects the selected vertices of pages and makes an answer of them.

#include <array>
#include <memory_resource>
#include <span>
#include <vector>

#include "engine/dense/square_bits.hpp"
#include "engine/machine/large_memory.hpp"
#include "query/pages/kept_heights.hpp"

namespace talus {

/// The place of a sample in its page.
struct PageSample {
  std::uint16_t col, row;
};

/// The vertices of an answer in the square of a dense page.
struct SquareOfAnswer {
  GridPoint first;    ///< of the square
  std::int64_t base;  ///< heights are more than the numbers by this
  SquareBits bits;
  const std::int16_t* numbers;  ///< row by row
};

/// Collects vertices page by page, then makes a quadtree of them.
class AnswerBuilder {
 public:
  /// expected_bytes  memory for the vertices, 16 bytes each; it grows when there are more
  AnswerBuilder(const StoredPages& pages, QueryCost& cost, std::size_t expected_bytes = std::size_t{1} << 16)
      : pages_(pages), cost_(cost), kept_(pages, cost), memory_(expected_bytes, &large_) {}
  AnswerBuilder(const AnswerBuilder&) = delete;
  AnswerBuilder& operator=(const AnswerBuilder&) = delete;

  void begin_page() { pages_found_.emplace_back(&memory_); }
  /// Adds an own vertex, sample i at p, of the page that begin_page() began.
  void take(const Page& page, std::size_t i, GridPoint p) {
    OfPage& here = pages_found_.back();
    here.at.push_back(p);
    here.heights.push_back(kept_.is_kept(page, i, p) ? page.height(i) : kept_.at(p));
    if (!page.covers.empty()) here.covers.push_back(page.covers[i]);
  }
  /// Adds all selected vertices of a page at once, without begin_page().
  void take(const Page& page, std::span<const PageSample> samples);
  /// Adds some vertices of a slice: those at `chosen`, which are grid points `at`.
  void take(const TileSlice& slice, std::span<const std::uint32_t> chosen, std::span<const GridPoint> at);
  /// Whether the database keeps the heights of all vertices.
  [[nodiscard]] bool all_are_kept() const { return kept_.all_are_kept(); }
  /// Adds the heights of many vertices of a dense page without voids and covers. The database keeps all.
  ///
  /// bits  all vertices of the answer in the page's square; those of coarser bands must be added, too
  void take(const Page& page, const SquareBits& bits);

  /// `vertices` holds the added vertices. Border vertices amid voids may be in it, too: the quadtree omits them.
  [[nodiscard]] RestrictedQuadtree quadtree(GridRect region, VertexMask vertices) const;
  /// One quadtree of the vertices of several builders. `vertices` holds exactly these.
  [[nodiscard]] static RestrictedQuadtree quadtree(std::span<const AnswerBuilder* const> parts, GridRect region,
                                                   VertexMask vertices, int threads);

 private:
  struct OfPage {
    explicit OfPage(std::pmr::memory_resource* memory) : at(memory), heights(memory), covers(memory) {}
    std::pmr::vector<GridPoint> at;
    std::pmr::vector<double> heights;
    std::pmr::vector<std::uint8_t> covers;  ///< empty: all 15
  };

  void write_squares(const VertexMask& vertices, std::span<double> heights) const;
  void write_pages(const VertexMask& vertices, RestrictedQuadtree& answer) const;

  [[nodiscard]] bool is_height(double code) const;
  const StoredPages& pages_;
  QueryCost& cost_;
  KeptHeights kept_;
  LargePages large_;
  std::pmr::monotonic_buffer_resource memory_;
  std::vector<OfPage> pages_found_;
  std::vector<SquareOfAnswer> squares_found_;  ///< their numbers are in memory_
};

}  // namespace talus
