#include "engine/triangulation.hpp"

#include <array>
#include <limits>

#include "engine/popcnt.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

using Corners = std::array<std::uint32_t, 3>;
constexpr std::size_t kMostAround = 4;  ///< triangles with a vertex at their right angle

/// From the right angle the left corner lies counter-clockwise before the right one, seen from above:
/// columns run east, rows south.
constexpr bool is_counter_clockwise(const Triangle& t) {
  const std::int64_t lc = t.left.col - t.apex.col, lr = t.left.row - t.apex.row;
  const std::int64_t rc = t.right.col - t.apex.col, rr = t.right.row - t.apex.row;
  return lr * rc - lc * rr > 0;
}

GridRect answered(const RestrictedQuadtree& quadtree) {
  return quadtree.region.cols() > 0 ? quadtree.region : quadtree.vertices.region();
}

class Emitter {
 public:
  Emitter(const RestrictedQuadtree& quadtree, Mesh& mesh)
      : quadtree_(quadtree),
        mask_(quadtree.vertices),
        region_(answered(quadtree)),
        window_(mask_.region()),
        reaches_out_(!(region_ == window_)),
        points_(mesh.points.data()),
        out_(mesh.triangles.data()),
        last_(out_ + mesh.triangles.size() - kMostAround) {}

  /// Emits the leaves around every vertex; returns one past the last triangle. A triangle is always written
  /// and then kept or not: whether it is a leaf is a coin toss to a branch predictor.
  ///
  /// fails  corrupt: corners that are not there
  TALUS_INLINE Corners* run() {
    const bool all_covered = quadtree_.covers.empty();
    std::uint32_t self = 0;
    mask_.for_each([&](GridPoint p) __attribute__((always_inline)) {
      points_[self] = p;
      const bool inner = p.col > region_.first.col && p.col < region_.last.col && p.row > region_.first.row &&
                         p.row < region_.last.row;
      const std::uint8_t covers = all_covered ? std::uint8_t{15} : quadtree_.covers[self];
      if (inner && covers == 15 && ((p.col | p.row) & 1) != 0) {
        ((p.col & p.row) & 1) != 0 ? finest_centre(p, self) : finest_side(p, self);
      } else {
        any(p, self, covers);
      }
      ++self;
      if (out_ > last_) refuse();  // what follows might not fit
    });
    if (!closed_) refuse();
    return out_;
  }

 private:
  [[noreturn]] static void refuse() {
    throw Failure(Cause::corrupt,
                  "corrupt: vertices without their parents make no mesh: the errors that selected them are damaged");
  }

  TALUS_INLINE void keep(Corners corners, bool leaf) {
    *out_ = corners;
    out_ += leaf ? 1 : 0;
  }

  /// All four neighbours are there and nothing is finer.
  TALUS_INLINE void finest_side(GridPoint p, std::uint32_t self) {
    const std::uint32_t north = mask_.rank({p.col, p.row - 1}), south = mask_.rank({p.col, p.row + 1});
    const std::uint32_t west = self - 1, east = self + 1;
    closed_ &= mask_.contains({p.col, p.row - 1}) & mask_.contains({p.col, p.row + 1}) &
               mask_.contains({p.col - 1, p.row}) & mask_.contains({p.col + 1, p.row});
    keep({self, north, west}, true);
    keep({self, west, south}, true);
    keep({self, south, east}, true);
    keep({self, east, north}, true);
  }

  /// All four corners are there; between them a side midpoint may be.
  TALUS_INLINE void finest_centre(GridPoint p, std::uint32_t self) {
    const bool north = mask_.contains({p.col, p.row - 1}), south = mask_.contains({p.col, p.row + 1});
    const bool west = mask_.contains({p.col - 1, p.row}), east = mask_.contains({p.col + 1, p.row});
    const std::uint32_t nw = mask_.rank({p.col - 1, p.row - 1}), ne = nw + 1 + (north ? 1 : 0);
    const std::uint32_t sw = mask_.rank({p.col - 1, p.row + 1}), se = sw + 1 + (south ? 1 : 0);
    closed_ &= mask_.contains({p.col - 1, p.row - 1}) & mask_.contains({p.col + 1, p.row - 1}) &
               mask_.contains({p.col - 1, p.row + 1}) & mask_.contains({p.col + 1, p.row + 1});
    keep({self, ne, nw}, !north);
    keep({self, nw, sw}, !west);
    keep({self, sw, se}, !south);
    keep({self, se, ne}, !east);
  }

  void any(GridPoint p, std::uint32_t self, std::uint8_t covers) {
    if (covers == 0 || spacing(p) == kRootSpacing) return;
    const bool finest = ((p.col ^ p.row) & 1) != 0;
    const Diamond d = diamond(p);
    for (std::size_t side = 0; side < 2; ++side) {
      const GridPoint apex = d.apexes[side];
      if (!window_.contains(apex)) continue;
      for (std::size_t end = 0; end < 2; ++end) {
        const GridPoint other = d.ends[end];
        if ((covers >> (2 * side + end) & 1) == 0 || !window_.contains(other)) continue;
        if (reaches_out_ && !meets({p, apex, other}, region_)) continue;
        if (!finest && mask_.contains(midpoint(apex, other))) continue;
        const std::uint32_t left = mask_.rank(apex), right = mask_.rank(other);
        closed_ &= mask_.contains(apex) & mask_.contains(other);
        const bool ccw = is_counter_clockwise({p, apex, other});
        keep(ccw ? Corners{self, left, right} : Corners{self, right, left}, true);
      }
    }
  }

  const RestrictedQuadtree& quadtree_;
  const VertexMask& mask_;
  GridRect region_, window_;
  bool reaches_out_;
  GridPoint* points_;
  Corners* out_;
  const Corners* last_;  ///< out_ may stand here and no further
  bool closed_ = true;   ///< so far
};

TALUS_POPCNT Corners* emit_popcnt(const RestrictedQuadtree& quadtree, Mesh& mesh) {
  return Emitter(quadtree, mesh).run();
}
Corners* emit_plain(const RestrictedQuadtree& quadtree, Mesh& mesh) { return Emitter(quadtree, mesh).run(); }

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
  mesh.region = answered(quadtree);
  mesh.heights = quadtree.heights;
  mesh.points.resize(quadtree.vertices.size());
  mesh.triangles.resize(2 * quadtree.vertices.size() + kMostAround);  // a planar mesh has fewer; room to write ahead
  const Corners* end = has_popcnt() ? emit_popcnt(quadtree, mesh) : emit_plain(quadtree, mesh);
  mesh.triangles.resize(static_cast<std::size_t>(end - mesh.triangles.data()));
  // Without voids every vertex of a region with an area is the corner of a triangle in it.
  const bool reaches_out = !(mesh.region == quadtree.vertices.region());
  if (!quadtree.covers.empty() || mesh.triangles.empty() || reaches_out) drop_unused(mesh);
  return mesh;
}

}  // namespace talus
