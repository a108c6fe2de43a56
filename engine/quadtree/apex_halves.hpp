#pragma once
// The four apex triangles of a vertex as offsets, for loops over rows. grid.hpp has the same as points.

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/quadtree/grid.hpp"

namespace talus {

/// Kinds of vertices that have the same neighbours at every level.
enum class VertexKind : std::uint8_t { level_side, upright_side, falling_centre, rising_centre };

/// The kind of a vertex of spacing s.
[[nodiscard]] constexpr VertexKind kind_of(GridPoint p, std::int32_t s) {
  const bool col_odd = (p.col & s) != 0, row_odd = (p.row & s) != 0;
  if (col_odd != row_odd) return col_odd ? VertexKind::level_side : VertexKind::upright_side;
  return (((p.col - s) ^ (p.row - s)) & (2 * s)) == 0 ? VertexKind::falling_centre : VertexKind::rising_centre;
}

[[nodiscard]] constexpr bool is_centre(VertexKind kind) { return kind >= VertexKind::falling_centre; }

/// An apex triangle as a half of the diamond of the vertex that splits it: the offset of that vertex (in spacings for a
/// centre, in half spacings for a side midpoint) and the half. The triangles of a finest side midpoint are never split.
struct ApexHalf {
  std::int8_t col, row;
  std::uint8_t side;
};

/// In the order of apex_triangles().
[[nodiscard]] constexpr std::array<ApexHalf, 4> apex_halves(VertexKind kind) {
  constexpr ApexHalf n{0, -1, 1}, w{-1, 0, 1}, e{1, 0, 0}, s{0, 1, 0};
  constexpr ApexHalf nw{-1, -1, 1}, ne{1, -1, 1}, sw{-1, 1, 0}, se{1, 1, 0};
  switch (kind) {
    case VertexKind::level_side: return {nw, ne, sw, se};
    case VertexKind::upright_side: return {nw, sw, ne, se};
    case VertexKind::falling_centre: return {n, e, w, s};
    default: return {n, w, e, s};
  }
}

/// The apex triangles of a finest side midpoint that are valid, as four bits. `valid` points to the vertex; its four
/// neighbours must be in the array, rows `stride` apart.
[[nodiscard]] inline std::uint8_t finest_apex_triangles(const std::uint8_t* valid, std::ptrdiff_t stride,
                                                        VertexKind kind) {
  const unsigned v = valid[0], n = v & valid[-stride], s = v & valid[stride], w = valid[-1], e = valid[1];
  const unsigned nw = n & w, ne = n & e, sw = s & w, se = s & e;
  return static_cast<std::uint8_t>(kind == VertexKind::level_side ? nw | ne << 1 | sw << 2 | se << 3
                                                                  : nw | sw << 1 | ne << 2 | se << 3);
}

}  // namespace talus
