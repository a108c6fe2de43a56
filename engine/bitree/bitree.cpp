// Bitrees: which triangles are split, and the heights that follow.
//
// A triangle is named by the midpoint of its hypotenuse and the side of the diamond that it is on; one bit says whether
// it is split. It exists if the triangle that it is a half of is split, so splitting it splits everything it lies in,
// and nothing else. A restricted quadtree splits both triangles of a diamond.
//
// The errors that select vertices were computed with source heights at all corners. A fictitious corner has another
// height, so triangles with one are measured again. Where one is too far from its samples, the corner that is farthest
// from its own sample is selected. That changes other triangles, so it repeats until none is too far. In the worst case
// all corners have source heights, and the computed errors hold. [A §2.2, §3.2]

#include "talus/bitree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "engine/error/height_field.hpp"
#include "engine/error/vertex_error.hpp"
#include "engine/error/voids.hpp"
#include "engine/machine/fail.hpp"
#include "engine/quadtree/border.hpp"
#include "engine/quadtree/grid.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "engine/quadtree/rect.hpp"

namespace talus {
namespace {

constexpr std::uint8_t split_bit(int side) { return side == 0 ? Bitree::kSplitsFirst : Bitree::kSplitsSecond; }

/// The half of the diamond of `middle` whose right angle is at `apex`.
constexpr int side_at(GridPoint middle, GridPoint apex) { return diamond(middle).apexes[0] == apex ? 0 : 1; }

/// All vertices of a region, and the triangles that they split.
class Hierarchy {
 public:
  explicit Hierarchy(GridRect region)
      : region_(region), root_(root_side(region)), kinds_(static_cast<std::size_t>(region.samples()), 0) {
    for (const GridPoint p : border_vertices(region, root_)) kind(p) = kAll;
    if (region.contains({0, 0})) kind({0, 0}) = kAll;  // the only root corner inside data
  }

  [[nodiscard]] GridRect region() const { return region_; }
  [[nodiscard]] std::uint8_t kind(GridPoint p) const { return kinds_[index(p)]; }
  [[nodiscard]] bool is_selected(GridPoint p) const { return (kind(p) & Bitree::kSelected) != 0; }
  [[nodiscard]] std::size_t index(GridPoint p) const { return index_in(region_, p); }
  [[nodiscard]] bool is_split(GridPoint middle, int side) const { return (kind(middle) & split_bit(side)) != 0; }

  void select(GridPoint p) {
    kind(p) |= Bitree::kSelected;
    if (spacing(p) >= root_) return;
    split(p, 0);
    split(p, 1);
  }

  /// visit(GridPoint) for each grid point of the region, coarsest first, so the ends of a diamond before its vertex.
  template <class Visit>
  void for_each_from_coarsest(Visit&& visit) const {
    const auto up = [](std::int32_t v, std::int32_t s) { return (v + s - 1) & -s; };
    for (std::int32_t s = root_; s >= 1; s /= 2) {
      for (std::int32_t row = up(region_.first.row, s); row <= region_.last.row; row += s) {
        // A row that is odd in this spacing has vertices of this level in every column, an even one in every second.
        const bool all = (row & s) != 0 || s == root_;
        std::int32_t col = up(region_.first.col, s);
        if (!all && (col & s) == 0) col += s;
        for (; col <= region_.last.col; col += all ? s : 2 * s) visit(GridPoint{col, row});
      }
    }
  }

  /// visit(Triangle) for each triangle of the region that is not split.
  template <class Visit>
  void for_each_leaf(Visit&& visit) const {
    for_each_point(region_, [&](GridPoint p) {
      if (kind(p) == 0 || spacing(p) >= root_) return;
      const auto triangles = apex_triangles(p);
      for (std::size_t at = 0; at < 4; ++at) {
        const Triangle& t = triangles[at];
        if ((kind(p) & split_bit(static_cast<int>(at / 2))) == 0) continue;
        if (!region_.contains(t.left) || !region_.contains(t.right)) continue;
        if (!is_finest(t)) {
          const GridPoint m = midpoint(t.left, t.right);
          if (is_split(m, side_at(m, p))) continue;
        }
        visit(t);
      }
    });
  }

 private:
  static constexpr std::uint8_t kAll = Bitree::kSelected | Bitree::kSplitsFirst | Bitree::kSplitsSecond;

  std::uint8_t& kind(GridPoint p) { return kinds_[index(p)]; }

  /// Splits a triangle and all that it lies in. Border vertices make sure that none of these crosses a side.
  void split(GridPoint middle, int side) {
    while (true) {
      const HalfDiamond t = half_diamond(middle, side);
      if (!inside(t, region_) || is_split(middle, side)) return;
      kind(middle) |= split_bit(side);
      if (spacing(t.apex) >= root_) return;
      const GridPoint above = diamond(t.apex).apexes[0];
      side = above == t.a || above == t.b ? 0 : 1;
      middle = t.apex;
    }
  }

  GridRect region_;
  std::int32_t root_;
  std::vector<std::uint8_t> kinds_;
};

/// Sets each height: a selected vertex has that of `source`, a fictitious one the mean of its diamond's ends.
template <class Source>
void settle_heights(const Hierarchy& h, Source&& source, std::vector<double>& heights) {
  h.for_each_from_coarsest([&](GridPoint p) {
    if (h.kind(p) == 0) return;
    if (h.is_selected(p)) {
      heights[h.index(p)] = source(p);
    } else {
      const Diamond d = diamond(p);
      heights[h.index(p)] = heights[h.index(d.ends[0])] / 2 + heights[h.index(d.ends[1])] / 2;
    }
  });
}

Bitree taken_from(const Hierarchy& h, std::span<const double> heights) {
  Bitree out;
  out.region = h.region();
  out.vertices = VertexMask(out.region);
  for_each_point(out.region, [&](GridPoint p) {
    if (h.kind(p) == 0) return;
    out.vertices.insert(p);
    out.kinds.push_back(h.kind(p));
    out.heights.push_back(heights[h.index(p)]);
    out.selected += h.is_selected(p) ? 1 : 0;
  });
  out.vertices.seal();
  out.bound = Metres{std::numeric_limits<double>::infinity()};
  return out;
}

/// The samples with their fills, and the distances of triangles from them. Keep the samples alive.
class SampledGround {
 public:
  SampledGround(const SampleWindow& samples, const BitreeOptions& options)
      : options_(options), region_(samples.region), heights_(samples.values) {
    std::span<const std::uint8_t> valid;
    if (std::find(samples.valid.begin(), samples.valid.end(), 0) != samples.valid.end()) {
      valid = samples.valid;
      voids_.emplace(region_, valid, height_in_tree({root_side(region_), 0}));
      filled_ = samples.values;
      fill_voids(region_, valid, *voids_, region_, filled_);
      heights_ = std::get<std::vector<double>>(filled_);
    }
    field_ = {region_, heights_, valid, CodeDistance({}, options.metres_per_unit)};
  }
  SampledGround(const SampledGround&) = delete;
  SampledGround& operator=(const SampledGround&) = delete;

  [[nodiscard]] const VoidMap* voids() const { return voids_ ? &*voids_ : nullptr; }
  [[nodiscard]] double height(GridPoint p) const { return heights_[field_.index(p)]; }
  [[nodiscard]] bool is_valid(GridPoint p) const { return field_.is_valid(field_.index(p)); }
  [[nodiscard]] double metres(double units) const { return field_.distance.metres(units); }

  /// The error of one half of a diamond in metres, its corners at the heights of `at`; 0 outside the region.
  template <class At>
  [[nodiscard]] double error(GridPoint middle, int side, At&& at) const {
    const HalfDiamond t = half_diamond(middle, side);
    if (!inside(t, region_)) return 0;
    const Holds holds = voids_ ? voids_->half(middle, side) : kData;
    if ((holds & kData) == 0) return 0;
    const double metres = field_.distance.metres(largest_distance(field_, t, plane_of(t, at)));
    return holds == kMixed ? std::max(metres, longest_side(t)) : metres;
  }

  /// Whether interpolation between the heights never rounds.
  [[nodiscard]] bool is_exact() const {
    BitRange used;
    for (const double h : heights_) used.take(h);
    // Fictitious vertices halve heights as often again as planes do.
    const std::int64_t side = std::max<std::int64_t>(region_.cols(), region_.rows());
    return field_.distance.is_binary() && side < 1 << 15 &&
           used.interpolates_exactly(static_cast<std::int32_t>(side * side));
  }

 private:
  /// The longest side on the ground in metres, times the void weight.
  [[nodiscard]] double longest_side(const HalfDiamond& t) const {
    return options_.void_weight * options_.cell.value * 2 * t.s * (t.centre ? std::sqrt(2.0) : 1.0);
  }

  BitreeOptions options_;
  GridRect region_;
  std::span<const double> heights_;
  Codes filled_;  ///< the samples with fills, if there are voids
  std::optional<VoidMap> voids_;
  HeightField field_;
};

void require(const SampleWindow& samples, Metres tolerance, const BitreeOptions& options) {
  const GridRect& r = samples.region;
  const bool fits = !is_empty(r) && r.cols() <= kMaxExtent && r.rows() <= kMaxExtent &&
                    samples.values.size() == static_cast<std::size_t>(r.samples()) &&
                    samples.valid.size() == samples.values.size();
  if (!fits) refuse("a bitree needs a region with one value and one valid flag a sample");
  if (!(tolerance.value >= 0)) refuse("the tolerance of a bitree must be 0 m or more");
  if (!(options.metres_per_unit > 0) || !(options.cell.value > 0) || !(options.void_weight > 0))
    refuse("BitreeOptions: metres_per_unit, cell and void_weight must be above 0");
  for (std::size_t i = 0; i < samples.values.size(); ++i) {
    if (samples.valid[i] && !std::isfinite(samples.values[i])) refuse("a valid height is not finite");
  }
}

/// Selects vertices until all triangles are within the tolerance; returns how many it selected.
std::size_t correct(Hierarchy& h, const SampledGround& ground, double tolerance, std::vector<double>& heights) {
  const auto source = [&](GridPoint p) { return ground.height(p); };
  const auto off = [&](GridPoint p) { return std::abs(heights[h.index(p)] - ground.height(p)); };
  std::size_t corrected = 0;
  while (true) {
    settle_heights(h, source, heights);
    std::vector<GridPoint> wrong;
    h.for_each_leaf([&](const Triangle& t) {
      const std::array<GridPoint, 3> corners{t.apex, t.left, t.right};
      const GridPoint worst =
          *std::max_element(corners.begin(), corners.end(), [&](GridPoint p, GridPoint q) { return off(p) < off(q); });
      if (off(worst) == 0) return;  // the corners have source heights: this triangle was measured before
      if (is_finest(t)) {
        const auto valid = [&](GridPoint p) { return ground.is_valid(p); };
        if (std::all_of(corners.begin(), corners.end(), valid) && ground.metres(off(worst)) > tolerance)
          wrong.push_back(worst);
        return;
      }
      const GridPoint m = midpoint(t.left, t.right);
      const auto at = [&](GridPoint p) { return heights[h.index(p)]; };
      if (ground.error(m, side_at(m, t.apex), at) > tolerance) wrong.push_back(worst);
    });
    if (wrong.empty()) return corrected;
    for (const GridPoint p : wrong) {
      corrected += h.is_selected(p) ? 0 : 1;
      h.select(p);
    }
  }
}

}  // namespace

Bitree bitree_of(const SampleWindow& samples, Metres tolerance, const BitreeOptions& options) {
  require(samples, tolerance, options);
  const SampledGround ground(samples, options);
  Hierarchy h(samples.region);
  const auto source = [&](GridPoint p) { return ground.height(p); };
  h.for_each_from_coarsest([&](GridPoint p) {
    if (h.is_selected(p)) return;
    if (ground.error(p, 0, source) > tolerance.value || ground.error(p, 1, source) > tolerance.value) h.select(p);
  });

  std::vector<double> heights(samples.values.size());
  std::size_t corrected = 0;
  if (options.verified) {
    corrected = correct(h, ground, tolerance.value, heights);
  } else {
    settle_heights(h, source, heights);
  }

  Bitree out = taken_from(h, heights);
  out.tolerance = tolerance;
  out.corrected = corrected;
  if (options.verified) out.bound = Metres{tolerance.value + (ground.is_exact() ? 0 : kRoundingMargin)};
  if (const VoidMap* voids = ground.voids()) {
    out.covers.reserve(out.vertices.size());
    out.vertices.for_each([&](GridPoint p) {
      out.covers.push_back(height_in_tree(p) < voids->levels() ? voids->apex_triangles_with_data(p) : std::uint8_t{0});
    });
  }
  return out;
}

Bitree complete_bitree(const VertexMask& selected, std::span<const double> heights) {
  if (is_empty(selected.region()) || heights.size() != selected.size())
    refuse("a bitree needs one height a selected vertex");
  Hierarchy h(selected.region());
  for (const GridPoint p : border_vertices(selected.region(), root_side(selected.region()))) {
    if (!selected.contains(p)) refuse("a bitree needs every vertex that the sides of its region need: select them too");
  }
  selected.for_each([&](GridPoint p) { h.select(p); });
  std::vector<double> all(static_cast<std::size_t>(selected.region().samples()));
  settle_heights(
      h, [&](GridPoint p) { return selected.contains(p) ? heights[selected.rank(p)] : 0.0; }, all);
  return taken_from(h, all);
}

}  // namespace talus
