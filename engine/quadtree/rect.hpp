#pragma once
// Arithmetic of rectangles of samples, both corners included.

#include <algorithm>
#include <cstddef>

#include "talus/units.hpp"

namespace talus {

[[nodiscard]] constexpr bool is_empty(GridRect r) { return r.cols() <= 0 || r.rows() <= 0; }

[[nodiscard]] constexpr bool overlap(GridRect a, GridRect b) {
  return a.first.col <= b.last.col && b.first.col <= a.last.col && a.first.row <= b.last.row &&
         b.first.row <= a.last.row;
}

/// The samples that both hold; is_empty() where they do not overlap.
[[nodiscard]] constexpr GridRect common(GridRect a, GridRect b) {
  return {{std::max(a.first.col, b.first.col), std::max(a.first.row, b.first.row)},
          {std::min(a.last.col, b.last.col), std::min(a.last.row, b.last.row)}};
}

/// The smallest rectangle that holds both.
[[nodiscard]] constexpr GridRect around(GridRect a, GridRect b) {
  return {{std::min(a.first.col, b.first.col), std::min(a.first.row, b.first.row)},
          {std::max(a.last.col, b.last.col), std::max(a.last.row, b.last.row)}};
}

[[nodiscard]] constexpr GridRect grown(GridRect r, std::int32_t by) {
  return {{r.first.col - by, r.first.row - by}, {r.last.col + by, r.last.row + by}};
}

/// The square of `side` samples whose first sample is `first`.
[[nodiscard]] constexpr GridRect square(GridPoint first, std::int32_t side) {
  return {first, {first.col + side - 1, first.row + side - 1}};
}

/// visit(p): the points of a rectangle, row by row.
template <class Visit>
constexpr void for_each_point(GridRect r, Visit&& visit) {
  for (std::int32_t row = r.first.row; row <= r.last.row; ++row) {
    for (std::int32_t col = r.first.col; col <= r.last.col; ++col) visit(GridPoint{col, row});
  }
}

/// Index of a sample among a rectangle's, row by row.
[[nodiscard]] constexpr std::size_t index_in(GridRect r, GridPoint p) {
  return static_cast<std::size_t>((std::int64_t{p.row} - r.first.row) * r.cols() + (std::int64_t{p.col} - r.first.col));
}

}  // namespace talus
