#pragma once
// One page in memory.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/dense/eighths_kernel.hpp"
#include "engine/dense/square_bits.hpp"
#include "engine/error/error_ladder.hpp"
#include "engine/error/height_field.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {

/// What a page knows of one of its child pages, so that questions read only those that they need.
struct ChildEntry {
  bool present = false;           ///< it is stored; false: it has voids only
  ErrorCode largest = 0;          ///< largest saturated error in it and in pages below it
  float lowest = 0, highest = 0;  ///< heights in the vertical unit, rounded outward; +inf and -inf: voids only
  std::uint32_t generation = 0;   ///< the last update that wrote it
  friend bool operator==(const ChildEntry&, const ChildEntry&) = default;
};

/// One entry for both: the larger error, the joined range of heights, the later generation.
[[nodiscard]] ChildEntry joined(const ChildEntry& a, const ChildEntry& b);

/// The code of each number of eighths, or null: errors of dense pages that do not follow from heights are eighths, too.
using CodesOfEighths = const std::array<ErrorCode, 1 << 15>*;
/// How a dense page has a code beside its eighths.
[[nodiscard]] constexpr std::int16_t coded(int code) { return static_cast<std::int16_t>(-1 - code); }

/// The dense form of a page: heights in 16 bits, and errors in eighths of a height code.
struct DenseSquares {
  alignas(64) std::int16_t numbers[kSquare];  ///< height codes less Page::base, row by row of the page's square
  /// Of own vertices in the extent; the others have no meaning. Below 0: coded(code).
  detail::SortedSquare errors;
};

/// A page to be encoded has heights and the errors of all own vertices. A decoded page is in one of two forms: dense,
/// as most pages of whole numbers are; or with heights, errors, and what follows from heights.
struct Page {
  PageId id;
  int bands = 1;  ///< bands of the database; the coarsest also holds all levels above
  PageGrid grid;

  bool is_dense = false;
  std::vector<DenseSquares> squares;  ///< dense: one; else without meaning
  std::int64_t base = 0;              ///< dense: what heights are more than the numbers of the square

  std::vector<double> heights;  ///< height codes, row by row; dense: empty
  /// Saturated; 0 for vertices of coarser bands. Decoded: 0 where implied. Dense: empty.
  std::vector<ErrorCode> errors;
  std::vector<std::uint16_t> coded;  ///< dense: places in the square of vertices whose errors are codes
  /// Decoded: errors that follow from heights (engine/page/page_errors.hpp) as exact distances in height codes; -1
  /// where there is none. In eighths if heights are whole numbers. Both empty: no error is implied.
  std::vector<std::int32_t> eighths;
  std::vector<double> distances;
  std::vector<std::uint8_t> valid;   ///< 1: valid, 0: void; empty: all are valid
  std::vector<std::uint8_t> covers;  ///< RestrictedQuadtree::covers of own vertices; empty: all 15
  std::vector<ChildEntry> children;  ///< kChildrenAcross² row by row; empty in the finest band

  /// Decoded: not empty if heights and errors are those of the slice of the tile. Then one: the samples of the square that
  /// the slice has. The heights of others are unspecified, their errors 0.
  std::vector<SquareBits> in_slice;

  [[nodiscard]] std::size_t index(std::int32_t col, std::int32_t row) const { return grid.index(col, row); }
  [[nodiscard]] std::size_t index(GridPoint p) const {
    const GridPoint here = grid.local(p);
    return index(here.col, here.row);
  }
  [[nodiscard]] bool is_own(GridPoint p) const { return band_of(p, bands) == id.band; }
  [[nodiscard]] bool is_data(std::size_t i) const { return valid.empty() || valid[i] != 0; }
  /// Whether the height of sample i was not stored.
  [[nodiscard]] bool is_dropped(std::size_t i) const { return is_sliced() && !has(in_slice.front(), in_square(i)); }
  [[nodiscard]] bool is_sliced() const { return !in_slice.empty(); }

  /// The height code of sample i.
  [[nodiscard]] double height(std::size_t i) const {
    return is_dense ? static_cast<double>(base + squares.front().numbers[in_square(i)]) : heights[i];
  }
  /// The error of an own vertex of a dense page in eighths of a height code, or coded(code); -1: not an own vertex.
  [[nodiscard]] std::int32_t dense_error(std::size_t i) const {
    const auto at = static_cast<std::int32_t>(in_square(i));
    const std::int32_t col = at % kPageSide, row = at / kPageSide;
    if (((col | row) & (kChildrenAcross - 1)) == 0) return -1;
    return squares.front().errors.numbers[detail::SortedSquare::index_of(col, row)];
  }
  /// For a decoded page: whether an error is a distance in height codes, not a code; the one and the other.
  [[nodiscard]] bool has_distance(std::size_t i) const {
    if (is_dense) return dense_error(i) >= 0;
    return eighths.empty() ? !distances.empty() && distances[i] >= 0 : eighths[i] >= 0;
  }
  [[nodiscard]] double distance_of(std::size_t i) const {
    if (is_dense) return dense_error(i) / 8.0;
    return eighths.empty() ? distances[i] : eighths[i] / 8.0;
  }
  [[nodiscard]] ErrorCode code(std::size_t i) const {
    return is_dense ? static_cast<ErrorCode>(-1 - dense_error(i)) : errors[i];
  }
  /// What the error of an own vertex counts as when it is compared with a tolerance: in a database of whole numbers
  /// eighths of a height code (see CodeDistance::eighths), in others the code.
  [[nodiscard]] std::int32_t counted_error(std::size_t i, const CodeDistance& distance) const {
    if (!distance.is_whole()) return error(i, distance);
    if (is_dense) return std::max(dense_error(i), 0);
    if (!has_distance(i)) return distance.counted(code(i));
    const double up = std::ceil(8 * distance_of(i));
    return up < kMostEighths ? static_cast<std::int32_t>(up) : kMostEighths;
  }
  /// What the error of an own vertex counts as, in metres. In a database of whole numbers it is a whole number of
  /// eighths: stored codes are rounded up. In others it is that of a code: errors that follow from heights are rounded
  /// up. So pages of all forms, and slices, agree which vertices a tolerance selects.
  [[nodiscard]] double error_m(std::size_t i, const CodeDistance& distance) const {
    if (!distance.is_whole()) return error_of(error(i, distance));
    return has_distance(i) ? distance.metres(std::ceil(8 * distance_of(i)) / 8) : distance.up_to_eighths(code(i));
  }
  /// The code that was stored, or else the smallest one that is not below the error.
  [[nodiscard]] ErrorCode error(std::size_t i, const CodeDistance& distance) const {
    return has_distance(i) ? error_code(distance.metres(distance_of(i))) : code(i);
  }

  /// Where sample i is in the page's square.
  [[nodiscard]] std::size_t in_square(std::size_t i) const {
    const auto cols = static_cast<std::size_t>(grid.cols), side = static_cast<std::size_t>(kPageSide);
    const auto col = static_cast<std::size_t>(grid.first.col & (kPageSide - 1));
    const auto row = static_cast<std::size_t>(grid.first.row & (kPageSide - 1));
    return cols == side ? i + row * side : (row + i / cols) * side + col + i % cols;
  }
};

/// The samples of a page's square that exist, and those of them that are data.
[[nodiscard]] SquareBits present_samples(const PageGrid& grid);
[[nodiscard]] SquareBits data_samples(const Page& page);
/// The samples for which `bytes`, row by row over the page's grid, has a 1 and not a 0.
[[nodiscard]] SquareBits marked_samples(const PageGrid& grid, std::span<const std::uint8_t> bytes);

/// An entry with the range of the page's valid stored heights, without an error.
[[nodiscard]] ChildEntry range_of(const Page& page, const HeightStep& step);

}  // namespace talus
