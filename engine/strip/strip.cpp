// The strip of a restricted quadtree, by bisection from the root.
//
// A path crosses a right triangle from one edge to another. When the triangle is split, the path crosses one half after
// the other, in an order that follows from the edges: six productions over types and turns (L left, R right):
//
//   AL -> CL BL    BL -> CR AL    CL -> AL BR
//   AR -> CR BR    BR -> CL AR    CR -> AR BL
//
// Eight root triangles stand around the origin; a path around it, counter-clockwise, crosses them BL CL BL CL ….
// Consecutive leaves of a mesh without cracks share an edge, so a run ends only where a triangle is not part of the
// answer. The code finds this by comparing edges.
//
// Inside the region and away from voids, a triangle needs one test: whether its midpoint is a vertex. [P98 §7] [D09
// §4.1]

#include "talus/strip.hpp"

#include <algorithm>
#include <array>

#include "engine/quadtree/grid.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

using enum StripType;

/// What must be tested for a triangle and its descendants.
enum class Asks {
  everything,  ///< the triangle may leave the region or the window
  covers,      ///< the triangle may hold no data
  nothing
};

constexpr bool right_angle_is_left(StripType type, bool turns_right) { return (type == a) != turns_right; }

class Walker {
 public:
  Walker(const RestrictedQuadtree& quadtree, GridRect region)
      : mask_(quadtree.vertices), window_(mask_.region()), region_(region), covers_(quadtree.covers) {
    const std::size_t room = 2 * mask_.size();  // a planar mesh has fewer triangles
    points_.resize(room);
    steps_.resize(room);
    if (!covers_.empty()) find_partial();
  }

  /// The root is the smallest four squares around the origin that hold the window. The database's root may be larger,
  /// but no triangle of the answer is. A square that the window fills is one run.
  void run() {
    const std::array<GridPoint, 8> around = points_around(window_);
    for (std::size_t i = 0; i < 8; i += 2) {
      const GridPoint first = around[i], middle = around[i + 1], last = around[(i + 2) % 8];
      if (!may_stand({0, 0}) || !may_stand(middle)) continue;
      if (may_stand(first)) walk<b, false, Asks::everything>({0, 0}, first, middle);
      if (may_stand(last)) walk<c, false, Asks::everything>({0, 0}, middle, last);
    }
    points_.resize(count_);
    steps_.resize(count_);
  }

  struct Begun {
    std::size_t first;
    GridPoint left, right;
  };
  [[nodiscard]] const std::vector<Begun>& runs() const { return runs_; }
  [[nodiscard]] Array<GridPoint>& points() { return points_; }
  [[nodiscard]] Array<StripStep>& steps() { return steps_; }

 private:
  template <StripType type, bool turns_right, Asks asks>
  void walk(GridPoint left, GridPoint right, GridPoint ahead) {
    constexpr bool at_left = right_angle_is_left(type, turns_right);
    const GridPoint apex = type == c ? ahead : at_left ? left : right;
    const GridPoint from = type != c && at_left ? right : left, to = type == c ? right : ahead;
    if constexpr (asks == Asks::everything) {
      if (!meets({apex, from, to}, region_)) return;
      if (region_.contains(left) && region_.contains(right) && region_.contains(ahead)) {
        return covers_.empty() ? walk<type, turns_right, Asks::nothing>(left, right, ahead)
                               : walk<type, turns_right, Asks::covers>(left, right, ahead);
      }
    }
    const bool finest = ((from.col ^ to.col) & 1) != 0;
    const GridPoint m{(from.col + to.col) >> 1, (from.row + to.row) >> 1};
    if (finest || is_absent<asks>(m)) {
      if (is_answered<asks>(apex, from, to)) emit<type, turns_right>(left, right, ahead);
      return;
    }
    constexpr bool L = false, R = true;
    if constexpr (type == a && !turns_right) {
      walk<c, L, asks>(left, right, m);
      walk<b, L, asks>(left, m, ahead);
    } else if constexpr (type == a) {
      walk<c, R, asks>(left, right, m);
      walk<b, R, asks>(m, right, ahead);
    } else if constexpr (type == b && !turns_right) {
      walk<c, R, asks>(left, right, m);
      walk<a, L, asks>(m, right, ahead);
    } else if constexpr (type == b) {
      walk<c, L, asks>(left, right, m);
      walk<a, R, asks>(left, m, ahead);
    } else if constexpr (!turns_right) {
      walk<a, L, asks>(m, right, ahead);
      walk<b, R, asks>(m, ahead, left);
    } else {
      walk<a, R, asks>(left, m, ahead);
      walk<b, L, asks>(ahead, m, right);
    }
  }

  /// A bit is faster to test than a rank, and few vertices stand beside voids.
  void find_partial() {
    partial_ = VertexMask(window_);
    std::size_t v = 0;
    mask_.for_each([&](GridPoint p) {
      if (covers_[v++] != 15) partial_.insert(p);
    });
  }

  /// A root corner in the window is missing if the database's root is larger and nothing depends on it.
  [[nodiscard]] bool may_stand(GridPoint corner) const { return !window_.contains(corner) || mask_.contains(corner); }

  /// Triangles outside the window are always split, because the mask ends there.
  template <Asks asks>
  [[nodiscard]] bool is_absent(GridPoint m) const {
    if constexpr (asks == Asks::everything) {
      if (!window_.contains(m)) return false;
    }
    return !mask_.contains(m);
  }

  /// Whether a leaf is a triangle of the answer.
  template <Asks asks>
  [[nodiscard]] bool is_answered(GridPoint apex, GridPoint from, GridPoint to) const {
    if constexpr (asks == Asks::nothing) {
      return true;
    } else {
      if constexpr (asks == Asks::everything) {
        for (const GridPoint p : {apex, from, to}) {
          if (!window_.contains(p) || !mask_.contains(p)) return false;
        }
      }
      if (covers_.empty() || !partial_.contains(apex)) return true;
      const Diamond d = diamond(apex);
      const unsigned bits = covers_[mask_.rank(apex)];
      const unsigned side = from == d.apexes[0] || to == d.apexes[0] ? 0 : 1;
      const unsigned end = from == d.ends[0] || to == d.ends[0] ? 0 : 1;
      return (bits >> (2 * side + end) & 1) != 0;
    }
  }

  template <StripType type, bool turns_right>
  void emit(GridPoint left, GridPoint right, GridPoint ahead) {
    if (!(left == left_ && right == right_)) [[unlikely]]
      runs_.push_back({count_, left, right});
    points_[count_] = ahead;
    steps_[count_++] = StripStep(type, turns_right);
    left_ = turns_right ? ahead : left;
    right_ = turns_right ? right : ahead;
  }

  const VertexMask& mask_;
  GridRect window_, region_;
  std::span<const std::uint8_t> covers_;
  VertexMask partial_;          ///< vertices beside triangles without data
  GridPoint left_{}, right_{};  ///< the edge where the path left the last triangle
  std::size_t count_ = 0;
  Array<GridPoint> points_;  ///< the corner ahead, by triangle
  Array<StripStep> steps_;
  std::vector<Begun> runs_;
};

/// The vertices that a strip uses. With voids, or outside the region, a vertex may be a corner of no triangle.
VertexMask used_vertices(GridRect window, const Walker& walker, std::span<const GridPoint> ahead) {
  VertexMask used(window);
  for (const GridPoint p : ahead) used.insert(p);
  for (const Walker::Begun& run : walker.runs()) {
    used.insert(run.left);
    used.insert(run.right);
  }
  used.seal();
  return used;
}

std::size_t count_swaps(const TriangleStrip& strip) {
  std::size_t swaps = 0;
  for (std::size_t i = 1; i < strip.steps.size(); ++i) {
    swaps += strip.steps[i].turns_right() == strip.steps[i - 1].turns_right() ? 1 : 0;
  }
  for (std::size_t i = 1; i < strip.runs.size(); ++i) {  // the first turn of a run is not a swap
    const auto first = static_cast<std::size_t>(strip.runs[i].first);
    swaps -= strip.steps[first].turns_right() == strip.steps[first - 1].turns_right() ? 1 : 0;
  }
  return swaps;
}

}  // namespace

TriangleStrip strip_of(const RestrictedQuadtree& quadtree) {
  const VertexMask& mask = quadtree.vertices;
  if (quadtree.heights.size() != mask.size() || (!quadtree.covers.empty() && quadtree.covers.size() != mask.size())) {
    throw Failure(Cause::corrupt, "corrupt: the answer does not have one height and one cover a vertex");
  }
  TriangleStrip strip;
  strip.region = quadtree.region.cols() > 0 ? quadtree.region : mask.region();
  if (mask.size() == 0) return strip;
  Walker walker(quadtree, strip.region);
  walker.run();
  const std::span<const GridPoint> ahead = walker.points();
  const bool all_used = quadtree.covers.empty() && strip.region == mask.region() && !ahead.empty();
  const VertexMask fewer = all_used ? VertexMask() : used_vertices(mask.region(), walker, ahead);
  const VertexMask& used = all_used ? mask : fewer;

  strip.corners.resize(ahead.size());
  used.ranks(ahead, strip.corners);
  for (const Walker::Begun& run : walker.runs()) {
    strip.runs.push_back({run.first, used.rank(run.left), used.rank(run.right)});
  }
  strip.points.resize(used.size());
  std::size_t next = 0;
  used.for_each([&](GridPoint p) { strip.points[next++] = p; });
  if (all_used) {
    strip.heights = quadtree.heights;
  } else {
    std::vector<std::uint32_t> ranks(used.size());
    mask.ranks(strip.points, ranks);
    strip.heights.resize(ranks.size());
    std::transform(ranks.begin(), ranks.end(), strip.heights.begin(),
                   [&](std::uint32_t r) { return quadtree.heights[r]; });
  }
  strip.steps = std::move(walker.steps());
  strip.swaps = count_swaps(strip);
  return strip;
}

Mesh mesh_of(const TriangleStrip& strip) {
  Mesh mesh;
  mesh.region = strip.region;
  mesh.points = strip.points;
  mesh.heights = strip.heights;
  mesh.triangles.resize(strip.triangles());
  for (std::size_t r = 0; r < strip.runs.size(); ++r) {
    const std::size_t end =
        r + 1 < strip.runs.size() ? static_cast<std::size_t>(strip.runs[r + 1].first) : strip.triangles();
    std::uint32_t left = strip.runs[r].left, right = strip.runs[r].right;
    for (auto t = static_cast<std::size_t>(strip.runs[r].first); t < end; ++t) {
      const std::uint32_t ahead = strip.corners[t];
      mesh.triangles[t] = {left, right, ahead};
      (strip.steps[t].turns_right() ? left : right) = ahead;
    }
  }
  return mesh;
}

Array<std::uint32_t> alternating_indices(const TriangleStrip& strip) {
  Array<std::uint32_t> out;
  out.reserve(strip.indices() + strip.swaps + 3 * strip.runs.size());
  for (std::size_t r = 0; r < strip.runs.size(); ++r) {
    const std::size_t end =
        r + 1 < strip.runs.size() ? static_cast<std::size_t>(strip.runs[r + 1].first) : strip.triangles();
    std::uint32_t left = strip.runs[r].left, right = strip.runs[r].right;
    // A triangle at an even position uses the last two vertices as left and right, one at an odd position as right and
    // left. Adding two or four vertices does not change that.
    const bool odd = out.size() % 2 != 0;
    const std::uint32_t first = odd ? right : left, second = odd ? left : right;
    if (!out.empty()) {
      out.push_back(out.back());
      out.push_back(first);
    }
    out.push_back(first);
    out.push_back(second);
    for (auto t = static_cast<std::size_t>(strip.runs[r].first); t < end; ++t) {
      const bool turns_right = strip.steps[t].turns_right();
      const std::uint32_t pivot = turns_right ? right : left, ahead = strip.corners[t];
      if (out.back() != pivot) out.push_back(pivot);
      out.push_back(ahead);
      (turns_right ? left : right) = ahead;
    }
  }
  return out;
}

}  // namespace talus
