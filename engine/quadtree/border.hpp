#pragma once
// The border constraint: the vertices that the sides of a rectangle need, so that no triangle leaves it and neighbours
// with a common side meet. [P98 §10]

#include <vector>

#include "engine/quadtree/grid.hpp"

namespace talus {

/// Longest mesh edge along a constrained side, in cells. Part of the format: databases with another value do not meet.
inline constexpr std::int32_t kLongestBorderEdge = 16;

/// The vertices inside `region` that its border needs at every tolerance, unordered, each once: those that its sides
/// need, its corners, and all their ancestors (an ancestor outside counts, but is not returned).
///
/// Each side is cut greedily into dyadic edges: from p on the line c an edge has length 2^min(tz c, tz p), at most
/// kLongestBorderEdge, halved until it fits. The mesh has the edge iff its younger end is selected: the end with
/// exactly one odd coordinate in units of the length.
///
/// cost  linear in the sides
[[nodiscard]] std::vector<GridPoint> border_vertices(GridRect region, std::int32_t root);

/// Whether a vertex keeps its height at any error. A triangle at it, or at a vertex that depends on it, may leave the
/// extent, and no error includes the samples beside such a triangle. If a vertex is near the border, so are its
/// parents: the apexes of a side midpoint are s away and reach 3s; their apexes are s further and reach 4s.
[[nodiscard]] constexpr bool is_near_border(GridPoint p, GridRect extent) {
  const std::int64_t s = spacing(p), reach = is_centre(p) ? 3 * s : 2 * s;
  return p.col - reach < extent.first.col || p.col + reach > extent.last.col || p.row - reach < extent.first.row ||
         p.row + reach > extent.last.row;
}

}  // namespace talus
