#pragma once
// Vertex by vertex: for small or nearly empty quadtrees, for regions that triangles may cross, and where the order of
// the triangles counts. triangulation_by_words is tested against it.

#include <stop_token>

#include "talus/quadtree.hpp"

namespace talus::detail {

/// triangulate() with triangles in the order of the vertices at their right angles, whatever the quadtree.
/// fails  as triangulate()
void triangulate_by_vertices(const RestrictedQuadtree& quadtree, Mesh& mesh, int threads, const std::stop_token& stop);

}  // namespace talus::detail
