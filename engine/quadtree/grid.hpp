#pragma once
// How grid points become vertices, diamonds and triangles.
//
// Every grid point except the corners of the root square is the split vertex of exactly one diamond, which follows from
// its coordinates (col, row). With s the lowest set bit of col|row:
//   col/s and row/s odd      the centre of a square of side 2s; the diamond is this square
//   exactly one of them odd  the midpoint of a side of such a square; the diamond is the square with half-diagonal s
//                            that stands on its corner
// The split cuts the diamond's hypotenuse a–b at the vertex; c and d are the apexes of its halves and the vertex's
// parents. Nothing depends on the extent: two databases on one grid agree, and a larger root changes no inner triangle.
// [P98 §3]

#include <array>
#include <bit>
#include <cstdint>

#include "talus/units.hpp"

namespace talus {

/// Spacing of the corners of a root square, which are above every level.
inline constexpr std::int32_t kRootSpacing = std::int32_t{1} << 30;

/// Spacing of p's level in cells: the lowest set bit of col|row; kRootSpacing for the origin.
[[nodiscard]] constexpr std::int32_t spacing(GridPoint p) {
  const auto bits = static_cast<std::uint32_t>(p.col | p.row);
  return bits == 0 ? kRootSpacing : static_cast<std::int32_t>(bits & (0u - bits));
}

/// log2 of the spacing; 0 for the finest vertices.
[[nodiscard]] constexpr int height_in_tree(GridPoint p) {
  return std::countr_zero(static_cast<std::uint32_t>(spacing(p)));
}

[[nodiscard]] constexpr bool is_centre(GridPoint p) {
  const std::int32_t s = spacing(p);
  return (p.col & s) != 0 && (p.row & s) != 0;
}

[[nodiscard]] constexpr GridPoint midpoint(GridPoint p, GridPoint q) {
  return {p.col + (q.col - p.col) / 2, p.row + (q.row - p.row) / 2};
}

/// The two triangles that a vertex splits: hypotenuse from ends[0] to ends[1], right angles at apexes[0] and apexes[1].
/// The apexes are the vertex's parents.
struct Diamond {
  std::array<GridPoint, 2> ends, apexes;
};

[[nodiscard]] constexpr Diamond diamond(GridPoint p) {
  const std::int32_t s = spacing(p);
  const std::int32_t w = p.col - s, e = p.col + s, n = p.row - s, south = p.row + s;
  const bool col_odd = (p.col & s) != 0, row_odd = (p.row & s) != 0;
  if (col_odd && row_odd) {
    // The diagonal joins the corners with an even sum of coordinates, in units of the square's size.
    const bool even = ((w ^ n) & (2 * s)) == 0;
    if (even) return {{GridPoint{w, n}, {e, south}}, {GridPoint{e, n}, {w, south}}};
    return {{GridPoint{e, n}, {w, south}}, {GridPoint{w, n}, {e, south}}};
  }
  if (col_odd) return {{GridPoint{w, p.row}, {e, p.row}}, {GridPoint{p.col, n}, {p.col, south}}};
  return {{GridPoint{p.col, n}, {p.col, south}}, {GridPoint{w, p.row}, {e, p.row}}};
}

/// The vertices that have p as a parent: four, or none for a finest side midpoint.
struct Children {
  std::array<GridPoint, 4> at{};
  int count = 0;
};

[[nodiscard]] constexpr Children children(GridPoint p) {
  const std::int32_t s = spacing(p);
  if (is_centre(p)) {
    return {{{{p.col - s, p.row}, {p.col + s, p.row}, {p.col, p.row - s}, {p.col, p.row + s}}}, 4};
  }
  const std::int32_t h = s / 2;
  if (h == 0) return {};
  return {{{{p.col - h, p.row - h}, {p.col + h, p.row - h}, {p.col - h, p.row + h}, {p.col + h, p.row + h}}}, 4};
}

/// A triangle with its right angle at `apex`.
struct Triangle {
  GridPoint apex, left, right;
};

/// Whether no sample is in the middle of its hypotenuse.
[[nodiscard]] constexpr bool is_finest(const Triangle& t) {
  return (((t.left.col ^ t.right.col) | (t.left.row ^ t.right.row)) & 1) != 0;
}

/// The halves of a split triangle: on the side of its left corner, and of its right corner.
[[nodiscard]] constexpr Triangle left_half(const Triangle& t) { return {midpoint(t.left, t.right), t.apex, t.left}; }
[[nodiscard]] constexpr Triangle right_half(const Triangle& t) { return {midpoint(t.left, t.right), t.apex, t.right}; }

/// The four triangles with their right angle at p. Triangle 2·side + end lies in the half of apexes[side] toward
/// ends[end]. RestrictedQuadtree::covers has its bits in this order.
[[nodiscard]] constexpr std::array<Triangle, 4> apex_triangles(GridPoint p) {
  const Diamond d = diamond(p);
  return {{{p, d.apexes[0], d.ends[0]},
           {p, d.apexes[0], d.ends[1]},
           {p, d.apexes[1], d.ends[0]},
           {p, d.apexes[1], d.ends[1]}}};
}

/// Whether a triangle of the hierarchy and a rectangle share more than a line (separating axis test).
[[nodiscard]] constexpr bool meets(const Triangle& t, GridRect rect) {
  if (rect.cols() < 2 || rect.rows() < 2) return false;  // the rectangle is a line
  const auto apart = [&](auto&& along) {
    const std::int64_t a = along(t.apex), b = along(t.left), c = along(t.right);
    const std::int64_t low = a < b ? (a < c ? a : c) : (b < c ? b : c),
                       high = a > b ? (a > c ? a : c) : (b > c ? b : c);
    std::int64_t from = along(rect.first), to = from;
    for (const GridPoint p :
         {rect.last, GridPoint{rect.first.col, rect.last.row}, GridPoint{rect.last.col, rect.first.row}}) {
      const std::int64_t v = along(p);
      from = v < from ? v : from;
      to = v > to ? v : to;
    }
    return high <= from || to <= low;
  };
  return !apart([](GridPoint p) { return std::int64_t{p.col}; }) &&
         !apart([](GridPoint p) { return std::int64_t{p.row}; }) &&
         !apart([](GridPoint p) { return std::int64_t{p.col} + p.row; }) &&
         !apart([](GridPoint p) { return std::int64_t{p.col} - p.row; });
}

/// Side of the smallest root square at the origin that is larger than the extent. No root triangle lies inside the
/// data, so no mesh has a special case for one.
[[nodiscard]] constexpr std::int32_t root_side(GridRect extent) {
  std::int32_t side = 1;
  while (side <= extent.last.col || side <= extent.last.row || -side >= extent.first.col || -side >= extent.first.row) {
    side *= 2;
  }
  return side;
}

/// visit(triangle): the two of each of the four root squares, which meet at the origin; none of a single sample's.
template <class Visit>
constexpr void for_each_root_triangle(GridRect extent, Visit&& visit) {
  const std::int32_t half = root_side(extent) / 2;
  if (half == 0) return;
  for (const std::int32_t row : {-half, half}) {
    for (const std::int32_t col : {-half, half}) {
      const Diamond d = diamond({col, row});
      for (const GridPoint apex : d.apexes) visit(Triangle{apex, d.ends[0], d.ends[1]});
    }
  }
}

/// The corners and the middles of the sides of the smallest four squares around the origin that hold a rectangle, from
/// the east counter-clockwise.
[[nodiscard]] constexpr std::array<GridPoint, 8> points_around(GridRect rect) {
  std::int32_t s = 1;
  for (const std::int32_t v : {-rect.first.col, -rect.first.row, rect.last.col, rect.last.row}) {
    while (s < v) s *= 2;
  }
  return {{{s, 0}, {s, -s}, {0, -s}, {-s, -s}, {-s, 0}, {-s, s}, {0, s}, {s, s}}};
}

/// The largest number of columns or rows of a grid: all diamonds stay within 32 bits.
inline constexpr std::int32_t kMaxExtent = std::int32_t{1} << 28;

}  // namespace talus
