#include "engine/triangulation.hpp"

#include <limits>

namespace talus {
namespace {

#if defined(__GNUC__) && defined(__x86_64__)
#define TALUS_INLINE [[gnu::always_inline]] inline
#define TALUS_POPCNT [[gnu::target("popcnt")]]
bool has_popcnt() { return __builtin_cpu_supports("popcnt") != 0; }
#else
#define TALUS_INLINE inline
#define TALUS_POPCNT
bool has_popcnt() { return false; }
#endif

/// From the right angle the left corner lies counter-clockwise before the right one, seen from above:
/// columns run east, rows south.
constexpr bool is_counter_clockwise(const Triangle& t) {
  const std::int64_t lc = t.left.col - t.apex.col, lr = t.left.row - t.apex.row;
  const std::int64_t rc = t.right.col - t.apex.col, rr = t.right.row - t.apex.row;
  return lr * rc - lc * rr > 0;
}

/// The leaves around one vertex. `rank` is VertexMask::rank.
template <class Rank>
TALUS_INLINE void emit(const RestrictedQuadtree& quadtree, GridPoint p, std::uint32_t self, Rank&& rank, Mesh& mesh) {
  const std::uint8_t covers = quadtree.covers.empty() ? std::uint8_t{15} : quadtree.covers[self];
  if (covers == 0 || spacing(p) == kRootSpacing) return;
  const VertexMask& mask = quadtree.vertices;
  const GridRect region = mask.region();
  const bool finest = ((p.col ^ p.row) & 1) != 0;
  const Diamond d = diamond(p);
  constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t end_rank[2] = {kUnknown, kUnknown};
  for (std::size_t side = 0; side < 2; ++side) {
    const GridPoint apex = d.apexes[side];
    if (!region.contains(apex)) continue;
    std::uint32_t apex_rank = kUnknown;
    for (std::size_t end = 0; end < 2; ++end) {
      const GridPoint other = d.ends[end];
      if ((covers >> (2 * side + end) & 1) == 0 || !region.contains(other)) continue;
      if (!finest && mask.contains(midpoint(apex, other))) continue;
      if (apex_rank == kUnknown) apex_rank = rank(apex);
      if (end_rank[end] == kUnknown) end_rank[end] = rank(other);
      if (is_counter_clockwise({p, apex, other})) mesh.triangles.push_back({self, apex_rank, end_rank[end]});
      else mesh.triangles.push_back({self, end_rank[end], apex_rank});
    }
  }
}

TALUS_INLINE void emit_all(const RestrictedQuadtree& quadtree, Mesh& mesh) {
  const VertexMask& mask = quadtree.vertices;
  std::uint32_t next = 0;
  mask.for_each([&](GridPoint p) {
    mesh.points[next] = p;
    emit(quadtree, p, next, [&](GridPoint q) { return mask.rank(q); }, mesh);
    ++next;
  });
}

// Counting bits is half of the work, and one instruction where there is one.
TALUS_POPCNT void emit_all_popcnt(const RestrictedQuadtree& quadtree, Mesh& mesh) { emit_all(quadtree, mesh); }
void emit_all_plain(const RestrictedQuadtree& quadtree, Mesh& mesh) { emit_all(quadtree, mesh); }

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
  mesh.points.resize(next);
  mesh.heights.resize(next);
  for (auto& t : mesh.triangles) {
    for (std::uint32_t& v : t) v = number[v];
  }
}

}  // namespace

Mesh triangulate(const RestrictedQuadtree& quadtree) {
  Mesh mesh;
  mesh.region = quadtree.vertices.region();
  mesh.heights = quadtree.heights;
  mesh.points.resize(quadtree.vertices.size());
  mesh.triangles.reserve(2 * quadtree.vertices.size());
  has_popcnt() ? emit_all_popcnt(quadtree, mesh) : emit_all_plain(quadtree, mesh);
  // Without voids every vertex of a region with an area is the corner of a triangle in it.
  if (!quadtree.covers.empty() || mesh.triangles.empty()) drop_unused(mesh);
  return mesh;
}

}  // namespace talus
