#include "engine/triangulation.hpp"

#include <limits>

namespace talus {
namespace {

/// East × north of the two legs from the right angle, by sign: columns run east, rows south.
bool is_counter_clockwise(const Triangle& t) {
  const std::int64_t lc = t.left.col - t.apex.col, lr = t.left.row - t.apex.row;
  const std::int64_t rc = t.right.col - t.apex.col, rr = t.right.row - t.apex.row;
  return lc * -rr - -lr * rc > 0;
}

/// Keeps the points that triangles use, in order.
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
  if (next == mesh.points.size()) return;
  mesh.points.resize(next);
  mesh.heights.resize(next);
  for (auto& t : mesh.triangles) {
    for (std::uint32_t& v : t) v = number[v];
  }
}

}  // namespace

Mesh triangulate(const RestrictedQuadtree& quadtree) {
  const VertexMask& mask = quadtree.vertices;
  const GridRect region = mask.region();
  Mesh mesh;
  mesh.region = region;
  mesh.heights = quadtree.heights;
  mesh.points.reserve(mask.size());
  mesh.triangles.reserve(2 * mask.size());
  mask.for_each([&](GridPoint p) {
    const auto self = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.push_back(p);
    const std::uint8_t covers = quadtree.covers.empty() ? 15 : quadtree.covers[self];
    if (covers == 0 || spacing(p) == kRootSpacing) return;
    const bool finest = spacing(p) == 1 && !is_centre(p);
    const auto triangles = apex_triangles(p);
    for (std::size_t i = 0; i < 4; ++i) {
      const Triangle& t = triangles[i];
      if ((covers >> i & 1) == 0 || !region.contains(t.left) || !region.contains(t.right)) continue;
      if (!finest && mask.contains(midpoint(t.left, t.right))) continue;
      const std::uint32_t left = mask.rank(t.left), right = mask.rank(t.right);
      if (is_counter_clockwise(t)) mesh.triangles.push_back({self, left, right});
      else mesh.triangles.push_back({self, right, left});
    }
  });
  drop_unused(mesh);
  return mesh;
}

}  // namespace talus
