#pragma once
// Collects the selected vertices of pages and makes an answer of them.

#include <memory_resource>
#include <span>
#include <vector>

#include "engine/machine/large_memory.hpp"
#include "query/pages/kept_heights.hpp"

namespace talus {

/// A sample of a page, by its place there.
struct PageSample {
  std::uint16_t col, row;
};

/// Collects vertices page by page, then makes a quadtree of them.
class AnswerBuilder {
 public:
  /// expected_bytes  of what is found, sixteen a vertex; more is found room for
  AnswerBuilder(const StoredPages& pages, QueryCost& cost, std::size_t expected_bytes = std::size_t{1} << 16)
      : pages_(pages), cost_(cost), kept_(pages, cost), memory_(expected_bytes, &large_) {}
  AnswerBuilder(const AnswerBuilder&) = delete;
  AnswerBuilder& operator=(const AnswerBuilder&) = delete;

  void begin_page() { pages_found_.emplace_back(&memory_); }
  /// An own vertex of the page that was begun.
  void take(const Page& page, std::size_t i, GridPoint p) {
    OfPage& here = pages_found_.back();
    here.at.push_back(p);
    here.heights.push_back(kept_.is_kept(page, i, p) ? page.heights[i] : kept_.at(p));
    if (!page.covers.empty()) here.covers.push_back(page.covers[i]);
  }
  /// All that are taken of a page.
  void take(const Page& page, std::span<const PageSample> samples);

  /// `vertices` must hold those taken and none else but such as nothing needs: their pages are not stored.
  [[nodiscard]] RestrictedQuadtree quadtree(GridRect region, VertexMask vertices) const;
  /// Of what several have found.
  [[nodiscard]] static RestrictedQuadtree quadtree(std::span<const AnswerBuilder* const> parts, GridRect region,
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

}  // namespace talus
