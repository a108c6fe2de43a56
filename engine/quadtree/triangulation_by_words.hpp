#pragma once
// By whole words of the mask's rows: 64 columns at a time, at about the speed of memory.

#include <stop_token>

#include "talus/quadtree.hpp"

namespace talus::detail {

/// Whether triangulate_by_words takes the quadtree, and is faster there than triangulate_by_vertices.
[[nodiscard]] bool is_worth_words(const RestrictedQuadtree& quadtree);

/// triangulate() for any quadtree whose region is that of its vertices. The triangles are those of
/// triangulate_by_vertices in another order, which depends on the quadtree alone.
/// fails  as triangulate()
void triangulate_by_words(const RestrictedQuadtree& quadtree, Mesh& mesh, int threads, const std::stop_token& stop);

}  // namespace talus::detail
