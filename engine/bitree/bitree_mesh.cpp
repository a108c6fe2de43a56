// The surface of a bitree: a walk over its triangles along a Sierpinski curve, and strips of triangles in any order.
//
// The walk crosses a triangle from one end of its hypotenuse to the other, so it crosses the halves one after the
// other. Consecutive triangles share a side or a part of one. Where the smaller one ends in the middle of the larger
// one's side, the larger one is cut there, in the direction of the walk. [A §4]

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "engine/quadtree/grid.hpp"
#include "talus/bitree.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

class Walk {
 public:
  explicit Walk(const Bitree& bitree) : bitree_(bitree), mask_(bitree.vertices), region_(bitree.region) {}

  /// visit(from, apex, to) for each triangle that is not split and holds data.
  template <class Visit>
  void run(Visit&& visit) const {
    const std::array<GridPoint, 8> around = points_around(region_);
    for (std::size_t i = 0; i < 8; i += 2) {
      go<false>({0, 0}, around[i], around[i + 1], visit);
      go<false>(around[i + 1], around[(i + 2) % 8], {0, 0}, visit);
    }
  }

 private:
  template <bool is_inside, class Visit>
  void go(GridPoint from, GridPoint apex, GridPoint to, Visit&& visit) const {
    if constexpr (!is_inside) {
      if (!meets({apex, from, to}, region_)) return;
      if (region_.contains(from) && region_.contains(apex) && region_.contains(to))
        return go<true>(from, apex, to, visit);
    }
    const bool finest = ((from.col ^ to.col) & 1) != 0;
    const GridPoint m{(from.col + to.col) >> 1, (from.row + to.row) >> 1};
    if (!finest && (!is_inside || is_split(m, apex))) {
      go<is_inside>(from, m, apex, visit);
      go<is_inside>(apex, m, to, visit);
    } else if (is_covered(from, apex, to)) {
      visit(from, apex, to);
    }
  }

  [[nodiscard]] bool is_split(GridPoint m, GridPoint apex) const {
    if (!mask_.contains(m)) return false;
    const std::uint8_t bit = diamond(m).apexes[0] == apex ? Bitree::kSplitsFirst : Bitree::kSplitsSecond;
    return (bitree_.kinds[mask_.rank(m)] & bit) != 0;
  }

  [[nodiscard]] bool is_covered(GridPoint from, GridPoint apex, GridPoint to) const {
    if (bitree_.covers.empty()) return true;
    const Diamond d = diamond(apex);
    const unsigned side = from == d.apexes[0] || to == d.apexes[0] ? 0 : 1;
    const unsigned end = from == d.ends[0] || to == d.ends[0] ? 0 : 1;
    return (bitree_.covers[mask_.rank(apex)] >> (2 * side + end) & 1) != 0;
  }

  const Bitree& bitree_;
  const VertexMask& mask_;
  GridRect region_;
};

void require_whole(const Bitree& bitree) {
  const std::size_t size = bitree.vertices.size();
  if (bitree.kinds.size() != size || bitree.heights.size() != size ||
      (!bitree.covers.empty() && bitree.covers.size() != size)) {
    throw Failure(Cause::corrupt, "corrupt: the bitree does not have one kind, height and cover a vertex");
  }
}

/// Cuts triangles at vertices on their sides.
class Cutter {
 public:
  explicit Cutter(const VertexMask& mask) : mask_(mask) {}

  /// Cuts a triangle; the walk goes from corner x to corner z.
  void cut(GridPoint x, GridPoint y, GridPoint z) {
    if (const GridPoint m = middle(x, z); is_between(m, x, z)) {
      cut(x, m, y);
      cut(y, m, z);
    } else if (const GridPoint n = middle(x, y); is_between(n, x, y)) {
      cut(x, z, n);
      cut(n, y, z);
    } else if (const GridPoint o = middle(y, z); is_between(o, y, z)) {
      cut(x, y, o);
      cut(o, x, z);
    } else {
      const std::int64_t turn = (std::int64_t{y.col} - x.col) * (std::int64_t{z.row} - x.row) -
                                (std::int64_t{y.row} - x.row) * (std::int64_t{z.col} - x.col);
      corners.insert(corners.end(), {x, turn < 0 ? y : z, turn < 0 ? z : y});  // rows run south
    }
  }

  std::vector<GridPoint> corners;

 private:
  static GridPoint middle(GridPoint p, GridPoint q) { return {(p.col + q.col) >> 1, (p.row + q.row) >> 1}; }
  /// Whether a vertex halves this side. No vertex lies elsewhere on a side, or inside the triangle.
  [[nodiscard]] bool is_between(GridPoint m, GridPoint p, GridPoint q) const {
    return ((p.col ^ q.col) & 1) == 0 && ((p.row ^ q.row) & 1) == 0 && mask_.contains(m);
  }
  const VertexMask& mask_;
};

using Corners = std::array<std::uint32_t, 3>;

bool has(const Corners& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

/// The corner of `t` that is not on the side shared with `other`; kNone if they share no side.
constexpr std::size_t kNone = 3;
std::size_t alone_in(const Corners& t, const Corners& other) {
  std::size_t alone = kNone;
  for (std::size_t i = 0; i < 3; ++i) {
    if (has(other, t[i])) continue;
    if (alone != kNone) return kNone;
    alone = i;
  }
  return alone;
}

}  // namespace

std::size_t leaf_triangles(const Bitree& bitree) {
  require_whole(bitree);
  std::size_t count = 0;
  Walk(bitree).run([&](GridPoint, GridPoint, GridPoint) { ++count; });
  return count;
}

Mesh mesh_of(const Bitree& bitree) {
  require_whole(bitree);
  const VertexMask& mask = bitree.vertices;
  Cutter cutter(mask);
  Walk(bitree).run([&](GridPoint from, GridPoint apex, GridPoint to) {
    for (const GridPoint p : {from, apex, to}) {
      if (!mask.contains(p)) throw Failure(Cause::corrupt, "corrupt: a triangle of the bitree lacks a corner");
    }
    cutter.cut(from, apex, to);
  });

  Mesh mesh;
  mesh.region = bitree.region;
  VertexMask used(mask.region());
  for (const GridPoint p : cutter.corners) used.insert(p);
  used.seal();
  used.for_each([&](GridPoint p) {
    mesh.points.push_back(p);
    mesh.heights.push_back(bitree.heights[mask.rank(p)]);
  });
  mesh.triangles.resize(cutter.corners.size() / 3);
  for (std::size_t i = 0; i < cutter.corners.size(); ++i) mesh.triangles[i / 3][i % 3] = used.rank(cutter.corners[i]);
  return mesh;
}

Array<std::uint32_t> alternating_indices(const Mesh& mesh) {
  Array<std::uint32_t> out;
  out.reserve(2 * mesh.triangles.size());
  std::uint32_t left = 0, right = 0;
  bool goes_on = false;  // the last two indices are left and right, in any order: the side shared with this triangle
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Corners& t = mesh.triangles[i];
    const std::size_t alone = i + 1 < mesh.triangles.size() ? alone_in(t, mesh.triangles[i + 1]) : kNone;
    if (!goes_on) {
      // A triangle whose third index has an even position keeps its winding, an odd one is reversed. Choose the first
      // two indices so that the second is used again by the next triangle, and the first repeats the last index if
      // possible.
      const bool odd = out.size() % 2 != 0;
      std::size_t best = 0, least = 99;
      for (std::size_t turn = 0; turn < 3; ++turn) {
        const std::size_t l = turn, r = (turn + 1) % 3, ahead = (turn + 2) % 3;
        const std::size_t first = odd ? r : l, second = odd ? l : r;
        if (alone == ahead) continue;  // the path would leave where it entered
        const std::size_t cost = (!out.empty() && out.back() != t[first] ? 2u : 0u) + (alone == second ? 1u : 0u);
        if (cost < least) least = cost, best = turn;
      }
      left = t[best];
      right = t[(best + 1) % 3];
      const std::uint32_t first = odd ? right : left, second = odd ? left : right;
      if (!out.empty() && out.back() != first) {
        out.push_back(out.back());
        out.push_back(first);
      }
      out.push_back(first);
      out.push_back(second);
    }
    std::uint32_t ahead = t[0];
    for (const std::uint32_t v : t) {
      if (v != left && v != right) ahead = v;
    }
    goes_on = alone != kNone && t[alone] != ahead;  // it leaves over another side than it entered
    if (goes_on) {
      const bool turns_right = t[alone] == left;
      const std::uint32_t pivot = turns_right ? right : left;
      if (out.back() != pivot) out.push_back(pivot);
      out.push_back(ahead);
      (turns_right ? left : right) = ahead;
    } else {
      out.push_back(ahead);
    }
  }
  return out;
}

}  // namespace talus
