#pragma once
// How the vertices of a grid are divided into pages: bands (ranges of levels) of squares.
//
// Band b holds the vertices with spacing 8^b, 2·8^b or 4·8^b; the coarsest band also all coarser ones. A page is one
// band of a square of 128·8^b cells, aligned to multiples of its side, its north and west sides included. It has 8×8
// child pages in band b−1. A page has the height of every 8^b-th sample of its square, coarser vertices included, so it
// is read without any other page. It has errors for the vertices of its own band only.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/quadtree/grid.hpp"
#include "engine/quadtree/rect.hpp"

namespace talus {

// The two constants of the layout, measured in docs/decisions/0001-pages.md. The manifest has them, because other
// values make another format.
inline constexpr int kBandLevels = 3;  ///< levels (spacings) in a band
inline constexpr int kPageShift = 7;   ///< log2 of samples along a page's side
inline constexpr std::int32_t kPageSide = 1 << kPageShift;
inline constexpr std::int32_t kChildrenAcross = 1 << kBandLevels;
static_assert(kPageShift >= kBandLevels && kPageShift <= 10 && kBandLevels >= 1);

/// Samples of a page's whole square.
inline constexpr std::size_t kSquare = static_cast<std::size_t>(kPageSide) * kPageSide;

/// The samples of a page's square that exist: columns first_col to end_col - 1, rows alike.
struct PresentRect {
  std::int32_t first_col = 0, end_col = kPageSide, first_row = 0, end_row = kPageSide;
  friend bool operator==(const PresentRect&, const PresentRect&) = default;
};

struct PageId {
  int band = 0;
  std::int32_t x = 0, y = 0;  ///< in page sides of the band, signed
  friend constexpr bool operator==(PageId, PageId) = default;
};

/// Cells between the samples of a band's pages.
[[nodiscard]] constexpr int band_shift(int band) { return band * kBandLevels; }
[[nodiscard]] constexpr std::int32_t band_spacing(int band) { return std::int32_t{1} << band_shift(band); }

/// Tiles compute bands 0 and 1 (engine/tile/tile.hpp), so there is always a band above them.
inline constexpr int kFewestBands = 3;

/// Number of bands of an extent. The pages of the coarsest band meet at the origin, so there are at most four; one if
/// the extent begins at the origin.
[[nodiscard]] constexpr int band_count(GridRect extent) {
  int bands = kFewestBands;
  while (root_side(extent) > std::int64_t{kPageSide} << band_shift(bands - 1)) ++bands;
  return bands;
}

/// The band of a vertex.
[[nodiscard]] constexpr int band_of(GridPoint p, int bands) {
  const int band = height_in_tree(p) / kBandLevels;
  return band < bands ? band : bands - 1;
}

[[nodiscard]] constexpr PageId page_of(GridPoint p, int band) {
  const int shift = band_shift(band) + kPageShift;
  return {band, p.col >> shift, p.row >> shift};
}

[[nodiscard]] constexpr PageId parent_page(PageId id) {
  return {id.band + 1, id.x >> kBandLevels, id.y >> kBandLevels};
}

/// The child page at `index` of the child entries, which are row by row.
[[nodiscard]] constexpr PageId child_page(PageId id, std::size_t index) {
  const auto i = static_cast<std::int32_t>(index);
  return {id.band - 1, id.x * kChildrenAcross + i % kChildrenAcross, id.y * kChildrenAcross + i / kChildrenAcross};
}

/// The page's square in cells: from its north-west sample to the last cell before the next page.
[[nodiscard]] constexpr GridRect page_square(PageId id) {
  const std::int64_t side = std::int64_t{kPageSide} << band_shift(id.band);
  const std::int64_t limit = std::int64_t{1} << 30;
  const auto cut = [&](std::int64_t v) {
    return static_cast<std::int32_t>(v < -limit ? -limit : v > limit ? limit : v);
  };
  return {{cut(id.x * side), cut(id.y * side)}, {cut((id.x + 1) * side - 1), cut((id.y + 1) * side - 1)}};
}

/// The samples of a page, in units of its band's spacing: its square inside the extent.
struct PageGrid {
  int shift = 0;
  GridPoint first;  ///< in units
  std::int32_t cols = 0, rows = 0;
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows); }
  [[nodiscard]] std::size_t index(std::int32_t col, std::int32_t row) const {  ///< of a page-relative sample
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
  [[nodiscard]] GridPoint at(std::int32_t col, std::int32_t row) const {  ///< grid point of a page-relative sample
    return {(first.col + col) * (1 << shift), (first.row + row) * (1 << shift)};
  }
  [[nodiscard]] GridPoint local(GridPoint p) const {  ///< page-relative column and row of a grid point
    return {(p.col >> shift) - first.col, (p.row >> shift) - first.row};
  }
};

[[nodiscard]] constexpr PageGrid page_grid(PageId id, GridRect extent) {
  const int shift = band_shift(id.band);
  const auto first_unit = [&](std::int32_t v) {
    return static_cast<std::int32_t>((std::int64_t{v} + (1 << shift) - 1) >> shift);
  };
  const std::int32_t col0 = id.x * kPageSide, row0 = id.y * kPageSide;
  const std::int32_t first_col = first_unit(extent.first.col) > col0 ? first_unit(extent.first.col) : col0;
  const std::int32_t first_row = first_unit(extent.first.row) > row0 ? first_unit(extent.first.row) : row0;
  const std::int32_t last_col = extent.last.col >> shift, last_row = extent.last.row >> shift;
  const std::int32_t end_col = (last_col < col0 + kPageSide - 1 ? last_col : col0 + kPageSide - 1) + 1;
  const std::int32_t end_row = (last_row < row0 + kPageSide - 1 ? last_row : row0 + kPageSide - 1) + 1;
  return {shift,
          {first_col, first_row},
          end_col > first_col ? end_col - first_col : 0,
          end_row > first_row ? end_row - first_row : 0};
}

/// The samples of a page in a rectangle, in page-relative columns and rows; last < first: none.
[[nodiscard]] constexpr GridRect samples_in(const PageGrid& grid, GridRect rect) {
  const std::int64_t ceil = (std::int64_t{1} << grid.shift) - 1;
  const auto from = [&](std::int32_t v, std::int32_t first) {
    const auto unit = static_cast<std::int32_t>((v + ceil) >> grid.shift) - first;
    return unit > 0 ? unit : 0;
  };
  const auto to = [&](std::int32_t v, std::int32_t first, std::int32_t count) {
    const std::int32_t unit = (v >> grid.shift) - first;
    return unit < count - 1 ? unit : count - 1;
  };
  return {{from(rect.first.col, grid.first.col), from(rect.first.row, grid.first.row)},
          {to(rect.last.col, grid.first.col, grid.cols), to(rect.last.row, grid.first.row, grid.rows)}};
}
/// visit(i, p) for each of them; i is the index in the page.
template <class Visit>
void for_each_in(const PageGrid& grid, GridRect rect, Visit&& visit) {
  for_each_point(samples_in(grid, rect),
                 [&](GridPoint at) { visit(grid.index(at.col, at.row), grid.at(at.col, at.row)); });
}

/// Whether is(i, p) holds for one of a page's samples; ends at the first.
template <class Is>
bool any_sample(const PageGrid& grid, Is&& is) {
  std::size_t i = 0;
  for (std::int32_t row = 0; row < grid.rows; ++row) {
    for (std::int32_t col = 0; col < grid.cols; ++col, ++i) {
      if (is(i, grid.at(col, row))) return true;
    }
  }
  return false;
}
/// visit(i, p) for all of a page's samples.
template <class Visit>
void for_each_sample(const PageGrid& grid, Visit&& visit) {
  any_sample(grid, [&](std::size_t i, GridPoint p) {
    visit(i, p);
    return false;
  });
}

/// The position of a page on a Morton curve: pages that are near on the map are mostly near in the file.
[[nodiscard]] constexpr std::uint64_t curve_position(PageId id) {
  const auto spread = [](std::int32_t v) {
    std::uint64_t bits = static_cast<std::uint32_t>(v) ^ 0x80000000u;  // signed order as unsigned
    bits = (bits | bits << 16) & 0x0000ffff0000ffff;
    bits = (bits | bits << 8) & 0x00ff00ff00ff00ff;
    bits = (bits | bits << 4) & 0x0f0f0f0f0f0f0f0f;
    bits = (bits | bits << 2) & 0x3333333333333333;
    return (bits | bits << 1) & 0x5555555555555555;
  };
  return spread(id.x) | spread(id.y) << 1;
}

/// The page at a position of the curve.
[[nodiscard]] constexpr PageId page_at(int band, std::uint64_t position) {
  const auto gather = [](std::uint64_t bits) {
    bits &= 0x5555555555555555;
    bits = (bits | bits >> 1) & 0x3333333333333333;
    bits = (bits | bits >> 2) & 0x0f0f0f0f0f0f0f0f;
    bits = (bits | bits >> 4) & 0x00ff00ff00ff00ff;
    bits = (bits | bits >> 8) & 0x0000ffff0000ffff;
    bits = (bits | bits >> 16) & 0x00000000ffffffff;
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(bits) ^ 0x80000000u);
  };
  return {band, gather(position), gather(position >> 1)};
}

/// All pages of a band whose squares meet an extent, in curve order. A page without samples can have child pages.
[[nodiscard]] std::vector<PageId> pages_of_band(int band, GridRect extent);

}  // namespace talus
