#pragma once
// From a restricted quadtree to its triangles, without recursion.

#include "engine/quadtree/grid.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// A triangle is a leaf of the hierarchy iff the vertex at its right angle is there and the midpoint of
/// its hypotenuse is not; so each vertex emits those of its four apex triangles whose midpoint is absent. Vertex
/// numbers are ranks in the mask. Only triangles with data that meet the region and lie in the mask's are emitted;
/// points no triangle uses are left out.
///
/// fails    corrupt: a triangle's corner is not in the set, which then is not closed
/// returns  counter-clockwise seen from above (columns east, rows south)
/// cost     linear in vertices and triangles
/// source   [P98 §3]; no recursion: design of ours, docs/architecture.md
[[nodiscard]] Mesh triangulate(const RestrictedQuadtree& quadtree, int threads);

}  // namespace talus
