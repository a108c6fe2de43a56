#include "engine/quadtree/leaves.hpp"

#include <algorithm>
#include <vector>

#include "engine/machine/fail.hpp"
#include "engine/machine/parallel.hpp"
#include "engine/quadtree/unused_points.hpp"

namespace talus::detail {
namespace {

/// Whether right angle, left and right are counter-clockwise seen from above: columns run east, rows south.
constexpr bool is_counter_clockwise(const Triangle& t) {
  const std::int64_t lc = t.left.col - t.apex.col, lr = t.left.row - t.apex.row;
  const std::int64_t rc = t.right.col - t.apex.col, rr = t.right.row - t.apex.row;
  return lr * rc - lc * rr > 0;
}

}  // namespace

GridRect answered(const RestrictedQuadtree& quadtree) {
  return quadtree.region.cols() > 0 ? quadtree.region : quadtree.vertices.region();
}

void refuse_not_closed() {
  fail(Cause::corrupt,
       "corrupt: a vertex lacks its parents, so there is no mesh: merge an increment first; otherwise the database is "
       "damaged");
}

void refuse_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Failure(Cause::cancelled, "cancelled: the caller stopped the triangulation");
}

LeavesAround::LeavesAround(const RestrictedQuadtree& quadtree)
    : mask_(quadtree.vertices),
      region_(answered(quadtree)),
      window_(mask_.region()),
      reaches_out_(!(region_ == window_)) {}

Corners* LeavesAround::write(GridPoint p, std::uint32_t self, std::uint8_t covers, Corners* out) {
  if (covers == 0 || spacing(p) == kRootSpacing) return out;
  const bool finest = ((p.col ^ p.row) & 1) != 0;
  const Diamond d = diamond(p);
  const std::int32_t s = spacing(p);
  // Where nothing is void or outside, corners are needed even if their triangle is split: they are parents.
  const bool whole = covers == 15 && !reaches_out_ && window_.contains({p.col - s, p.row - s}) &&
                     window_.contains({p.col + s, p.row + s});
  for (std::size_t side = 0; side < 2; ++side) {
    const GridPoint apex = d.apexes[side];
    if (!window_.contains(apex)) continue;
    for (std::size_t end = 0; end < 2; ++end) {
      const GridPoint other = d.ends[end];
      if ((covers >> (2 * side + end) & 1) == 0 || !window_.contains(other)) continue;
      if (reaches_out_ && !meets({p, apex, other}, region_)) continue;
      const bool split = !finest && mask_.contains(midpoint(apex, other));
      if (!split || whole) closed_ = closed_ && mask_.contains(apex) && mask_.contains(other);
      if (split) continue;
      const std::uint32_t left = mask_.rank(apex), right = mask_.rank(other);
      *out++ = is_counter_clockwise({p, apex, other}) ? Corners{self, left, right} : Corners{self, right, left};
    }
  }
  return out;
}

std::vector<RowRange> parts_of(const VertexMask& mask, int count) {
  const GridRect& region = mask.region();
  const auto before = [&](std::int64_t row) -> std::size_t {
    return row > region.last.row ? mask.size() : mask.rank({region.first.col, static_cast<std::int32_t>(row)});
  };
  std::vector<RowRange> parts;
  std::int64_t first = region.first.row;
  for (int i = 1; i <= count && first <= region.last.row; ++i) {
    const std::size_t wanted = mask.size() / static_cast<std::size_t>(count) * static_cast<std::size_t>(i);
    std::int64_t low = first, high = region.last.row;  // binary search for the last row of the part
    while (low < high && i < count) {
      const std::int64_t middle = low + (high - low) / 2;
      (before(middle + 1) >= wanted ? high : low) = before(middle + 1) >= wanted ? middle : middle + 1;
    }
    if (i == count) low = region.last.row;
    parts.push_back(
        {static_cast<std::int32_t>(first), static_cast<std::int32_t>(low), before(low + 1) - before(first)});
    first = low + 1;
  }
  return parts;
}

void begin_mesh(const RestrictedQuadtree& quadtree, Mesh& mesh) {
  mesh.region = answered(quadtree);
  mesh.triangles.clear();
  mesh.cuts.clear();
  resize_unset(mesh.points, quadtree.vertices.size());
  resize_unset(mesh.heights, quadtree.vertices.size());
}

void finish_mesh(const RestrictedQuadtree& quadtree, Mesh& mesh) {
  // Without voids, every vertex of a region with an area is a corner of a triangle.
  const bool reaches_out = !(mesh.region == quadtree.vertices.region());
  if (!quadtree.covers.empty() || mesh.triangles.empty() || reaches_out) remove_unused_points(quadtree, mesh);
}

int threads_for(std::size_t vertices, int threads) {
  constexpr std::size_t kWorthAThread = 1 << 16;
  return static_cast<int>(
      std::min<std::size_t>(static_cast<std::size_t>(threads_or_all(threads)), 1 + vertices / kWorthAThread));
}

}  // namespace talus::detail
