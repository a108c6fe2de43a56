#pragma once
// The border constraint: which vertices a rectangle's sides need, so that no triangle leaves the rectangle
// and neighbours that share a side agree on it. [P98 §10]

#include <vector>

#include "engine/quadtree/grid.hpp"

namespace talus {

/// Longest mesh edge along a constrained side, in cells. A constant of the format: two databases that
/// disagreed on it would not meet.
inline constexpr std::int32_t kLongestBorderEdge = 16;

/// The vertices inside `region` that its border needs whatever the tolerance, in no order, none twice.
///
/// Each side is cut greedily into maximal dyadic edges: from p on the line c the edge has length
/// 2^min(tz c, tz p), at most kLongestBorderEdge, halved until it fits. An edge is in the mesh iff its younger end is
/// selected, the one where exactly one coordinate over its length is odd. Those vertices, the region's
/// corners, and everything they depend on; what they depend on beyond the region counts, but is not returned.
///
/// cost  in proportion to the sides, times a small constant for the dependencies
[[nodiscard]] std::vector<GridPoint> border_vertices(GridRect region, std::int32_t root);

}  // namespace talus
