#include <cstdint>
#include <limits>
#include <vector>

#include "engine/quadtree/leaves.hpp"
#include "engine/quadtree/triangulation_by_vertices.hpp"
#include "engine/quadtree/triangulation_by_words.hpp"
#include "talus/failure.hpp"
#include "talus/quadtree.hpp"

namespace talus {
namespace {

/// Removes the points that no triangle uses.
void drop_unused(Mesh& mesh) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(mesh.points.size(), kUnused);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) number[v] = 0;
  }
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == kUnused) continue;
    mesh.points[next] = mesh.points[i];
    mesh.heights[next] = mesh.heights[i];
    number[i] = next++;
  }
  mesh.points.resize(next);
  mesh.heights.resize(next);
  for (auto& t : mesh.triangles) {
    for (std::uint32_t& v : t) v = number[v];
  }
}

void triangulate_into(const RestrictedQuadtree& quadtree, Mesh& mesh, int threads, const std::stop_token& stop) {
  mesh.region = detail::answered(quadtree);
  mesh.points.clear(), mesh.heights.clear(), mesh.triangles.clear(), mesh.cuts.clear();
  if (quadtree.vertices.size() == 0) return;
  if (detail::is_worth_words(quadtree)) {
    detail::triangulate_by_words(quadtree, mesh, threads, stop);
  } else {
    detail::triangulate_by_vertices(quadtree, mesh, threads, stop);
  }
  // Without voids, every vertex of a region with an area is a corner of a triangle.
  const bool reaches_out = !(mesh.region == quadtree.vertices.region());
  if (!quadtree.covers.empty() || mesh.triangles.empty() || reaches_out) drop_unused(mesh);
}

}  // namespace

Mesh triangulate(const RestrictedQuadtree& quadtree, int threads, const std::stop_token& stop) {
  Mesh mesh;
  triangulate(quadtree, mesh, threads, stop);
  return mesh;
}

void triangulate(const RestrictedQuadtree& quadtree, Mesh& into, int threads, const std::stop_token& stop) {
  within_memory([&] { triangulate_into(quadtree, into, threads, stop); });
}

}  // namespace talus
