#include "engine/quadtree/triangulation_by_vertices.hpp"
#include "engine/quadtree/triangulation_by_words.hpp"
#include "talus/failure.hpp"
#include "talus/quadtree.hpp"

namespace talus {

Mesh triangulate(const RestrictedQuadtree& quadtree, int threads, const std::stop_token& stop) {
  Mesh mesh;
  triangulate(quadtree, mesh, threads, stop);
  return mesh;
}

void triangulate(const RestrictedQuadtree& quadtree, Mesh& into, int threads, const std::stop_token& stop) {
  within_memory([&] {
    if (detail::is_worth_words(quadtree)) {
      detail::triangulate_by_words(quadtree, into, threads, stop);
    } else {
      detail::triangulate_by_vertices(quadtree, into, threads, stop);
    }
  });
}

}  // namespace talus
