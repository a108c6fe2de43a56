#pragma once
// Vertex by vertex: for small or nearly empty quadtrees, and for regions that triangles may cross. It takes every
// quadtree, and triangulation_by_words is tested against it.

#include <stop_token>

#include "talus/quadtree.hpp"

namespace talus::detail {

/// Fills `mesh` except its region. Points that no triangle uses stay.
/// fails  as triangulate()
void triangulate_by_vertices(const RestrictedQuadtree& quadtree, Mesh& mesh, int threads, const std::stop_token& stop);

}  // namespace talus::detail
