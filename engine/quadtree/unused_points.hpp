#pragma once
// Points of a mesh that no triangle uses: vertices amid voids, which others need as parents.

#include "talus/quadtree.hpp"

namespace talus::detail {

/// Removes them from the mesh of a quadtree with covers, or whose region is not that of its vertices.
///
/// cost  a look at each vertex, and beside voids at the few triangles around it; where there are many voids, or points
///       are removed, at each triangle
void remove_unused_points(const RestrictedQuadtree& quadtree, Mesh& mesh);

}  // namespace talus::detail
