#include "query/bounded/splitter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "engine/error/height_field.hpp"
#include "engine/quadtree/border.hpp"
#include "engine/quadtree/construction.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "engine/quadtree/triangulation_by_vertices.hpp"
#include "query/bounded/bounded_heights.hpp"
#include "query/pages/stopwatch.hpp"
#include "query/selection/range_query.hpp"
#include "query/selection/refusals.hpp"
#include "talus/failure.hpp"

namespace talus {

double Rounding::operator()(double height) const { return (std::nearbyint(height / unit_) + 0.0) * unit_; }

bool Rounding::is_exact() const {
  const double fraction = unit_ * (1 << 20);
  return fraction == std::nearbyint(fraction);
}

namespace {

/// Triangles that were compared with their samples: one bit for each half of a diamond.
class Checked {
 public:
  explicit Checked(GridRect region) : halves_{VertexMask(region), VertexMask(region)} {}
  [[nodiscard]] bool has(GridPoint middle, int side) const {
    return halves_[static_cast<std::size_t>(side)].contains(middle);
  }
  void insert(GridPoint middle, int side) { halves_[static_cast<std::size_t>(side)].insert(middle); }

 private:
  std::array<VertexMask, 2> halves_;
};

/// Splits triangles that are too far from a sample, from the coarsest on, until none is.
///
/// Rounded heights: `finest` is the answer at the tolerance minus the rounding. It has every vertex that may be needed:
/// a triangle that is too far with rounded heights is farther than that with exact ones, so its midpoint's error is
/// larger. Errors are saturated, so all that the midpoint depends on is selected, too.
///
/// Fitted heights: `finest` is the answer at tolerance 0, because samples may be too far anywhere. If it lacks a
/// midpoint, all samples lie in the plane of the source's heights, and no corner is farther from those than the
/// tolerance.
///
/// On the region's sides, exactly the answer at the tolerance minus the rounding is used, so that neighbours have the
/// same vertices. A triangle whose longest side may not be split there has three corners with the source's heights, so
/// it needs no split.
class Splitter {
 public:
  Splitter(const RoundedQuestion& question, Metres quantum, SplitHeights heights)
      : question_(question), quantum_(quantum), fits_(heights == SplitHeights::fitted) {
    const double tolerance = question.tolerance.value;
    // A triangle with data and void may have to be split for its size; the answer at the tolerance decides.
    if (has_voids_) for_its_voids_ = asked_too(question, Metres{tolerance}).vertices;
    if (fits_) {
      sides_ = asked_too(question, Metres{tolerance - rounding_of(description_, quantum)}).vertices;
      // Begin with the vertices of a looser answer: missing ones are added, and extra ones do no harm.
      constexpr double kLooser = 1.6;
      coarse_ = asked_too(question, Metres{tolerance * kLooser}).vertices;
      sources_.assign(finest_.quadtree.heights.begin(), finest_.quadtree.heights.end());
    }
    for (double& h : finest_.quadtree.heights) h = rounded_(h);
  }

  Answer run() {
    const Stopwatch running(finest_.cost.seconds);
    watch_.stage(fits_ ? "fitting heights" : "splitting triangles", kReading, 1);
    for (const GridPoint p : border_vertices(region_, root_)) insert(p);
    (fits_ ? sides_ : finest_.quadtree.vertices).for_each([&](GridPoint p) {
      if (is_on_side(p) || spacing(p) >= root_) insert(p);
    });
    if (!fits_) {
      while (split_once()) {
      }
      return answer();
    }
    coarse_.for_each([&](GridPoint p) { insert(p); });
    fix_heights();
    // Changed heights may help one triangle and harm another, so fitting and splitting alternate.
    constexpr int kFittedRounds = 12;
    for (int round = 0;; ++round) {
      if (round < kFittedRounds) {
        fit();
        checked_ = Checked(region_);
        farthest_ = 0;
      }
      if (!split_once()) return answer();
    }
  }

 private:
  static constexpr double kReading = 0.3;  ///< share of the time for exact answers

  static SampleWindow samples_for(const RoundedQuestion& question, bool fits) {
    require_inside(question.pages, question.region);
    question.watch.add_bytes(static_cast<std::uint64_t>(question.region.samples()) * (fits ? 26 : 9));
    question.watch.stage("reading samples", 0, kReading);
    return all_samples(question.pages, question.region, question.watch);
  }
  static Answer exact_answer(const RoundedQuestion& question, Metres tolerance) {
    const Watch::Aside none_of_these_is_of_the_answer(question.watch);
    return range_query(question.pages, question.region, tolerance, question.threads, {}, question.watch);
  }

  RestrictedQuadtree asked_too(const RoundedQuestion& question, Metres tolerance) {
    Answer answer = exact_answer(question, tolerance);
    watch_.give_back(answer.quadtree.vertices.size() * kBytesAVertex);  // only its mask is kept
    finest_.cost.pages_read += answer.cost.pages_read;
    finest_.cost.bytes_read += answer.cost.bytes_read;
    finest_.cost.pages_cached += answer.cost.pages_cached;
    finest_.border_vertices = answer.border_vertices;
    return std::move(answer.quadtree);
  }

  [[nodiscard]] bool is_on_side(GridPoint p) const {
    return p.col == region_.first.col || p.col == region_.last.col || p.row == region_.first.row ||
           p.row == region_.last.row;
  }
  [[nodiscard]] bool may_have(GridPoint p) const {
    return finest_.quadtree.vertices.contains(p) && (!fits_ || !is_on_side(p) || sides_.contains(p));
  }
  void insert(GridPoint p) {
    if (may_have(p)) chosen_.insert(p);
  }

  // ---- fitted heights ----------------------------------------------------------------------------------

  /// Fixes heights that must stay the source's: on the region's sides and beside them, and fills of voids.
  void fix_heights() {
    const RestrictedQuadtree& f = finest_.quadtree;
    is_fixed_.assign(f.vertices.size(), 0);
    std::size_t i = 0;
    f.vertices.for_each(
        [&](GridPoint p) { is_fixed_[i++] = is_on_side(p) || samples_.valid[samples_.index(p)] == 0 ? 1 : 0; });
    const auto fix_beside = [&](GridPoint p) {
      if (spacing(p) >= root_ || sides_.contains(p)) return;
      for (const GridPoint apex : diamond(p).apexes) {
        if (region_.contains(apex) && f.vertices.contains(apex)) is_fixed_[f.vertices.rank(apex)] = 1;
      }
    };
    for (std::int32_t col = region_.first.col; col <= region_.last.col; ++col)
      fix_beside({col, region_.first.row}), fix_beside({col, region_.last.row});
    for (std::int32_t row = region_.first.row; row <= region_.last.row; ++row)
      fix_beside({region_.first.col, row}), fix_beside({region_.last.col, row});
    fitted_ = sources_;
    for (i = 0; i < fitted_.size(); ++i) {
      if (is_fixed_[i] != 0) fitted_[i] = rounded_(fitted_[i]);
    }
  }

  /// Sweeps over all samples. A sample that is too far pulls the corners of its triangle towards it, by its weights,
  /// until it is within the limit. Ends when no sample is too far, or after the last sweep.
  void fit() {
    Mesh mesh;
    within_memory([&] { detail::triangulate_by_vertices(quadtree(), mesh, 1, {}); });  // the order decides
    RestrictedQuadtree& f = finest_.quadtree;
    std::vector<std::uint32_t> ranks(mesh.points.size());
    f.vertices.ranks(std::span(mesh.points.data(), mesh.points.size()), ranks);
    constexpr int kSweeps = 8;
    bool moved = true;
    for (int sweep = 0; moved && sweep < kSweeps; ++sweep) {
      moved = false;
      for (const auto& t : mesh.triangles) {
        watch_.look();
        const std::array<GridPoint, 3> corners{mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
        moved |= pull(corners, {ranks[t[0]], ranks[t[1]], ranks[t[2]]});
      }
    }
    for (const std::uint32_t rank : ranks) f.heights[rank] = rounded_(fitted_[rank]);
  }

  /// Returns whether a sample was too far.
  bool pull(const std::array<GridPoint, 3>& corners, const std::array<std::uint32_t, 3>& ranks) {
    const auto [apex, longest] = right_angle_of(corners);
    if (longest <= 2) return false;
    if (is_fixed_[ranks[0]] + is_fixed_[ranks[1]] + is_fixed_[ranks[2]] == 3) return false;
    const HalfDiamond half = half_over(corners, apex);
    const auto plane_with = [&](auto&& height_of) {
      return plane_of(half, [&](GridPoint p) { return height_of(corners[0] == p ? 0u : corners[1] == p ? 1u : 2u); });
    };
    const auto surface = [&] { return plane_with([&](std::size_t k) { return fitted_[ranks[k]]; }); };
    const double step = rounded_.unit();
    const double within = std::max(0.1 * limit_, 0.98 * limit_ - 0.45 * step),
                 reach = std::max(0.0, 0.999 * limit_ - 0.5 * step);
    Plane<double> plane = surface();
    bool left_out = false;
    for (std::int32_t row = half.top(); row <= half.bottom(); ++row) {
      const auto [first, last] = half.columns(row);
      std::size_t i = samples_.index({first, row});
      for (std::int32_t col = first; col <= last; ++col, ++i) {
        const double above = plane.on_row(row) + plane.right * (col - plane.col) - samples_.values[i];
        if (std::abs(above) <= within || samples_.valid[i] == 0) continue;
        left_out = true;
        std::array<double, 3> weight{};
        double squares = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          if (is_fixed_[ranks[k]] != 0) continue;
          const Plane<double> share = plane_with([&](std::size_t other) { return other == k ? 1.0 : 0.0; });
          weight[k] = share.on_row(row) + share.right * (col - share.col);
          squares += weight[k] * weight[k];
        }
        if (squares < 1e-9) continue;
        const double by = (above > 0 ? above - within : above + within) / squares;
        for (std::size_t k = 0; k < 3; ++k) {
          if (is_fixed_[ranks[k]] != 0) continue;
          double& height = fitted_[ranks[k]];
          const double source = sources_[ranks[k]];
          height = std::clamp(height - by * weight[k], source - reach, source + reach);
        }
        plane = surface();
      }
    }
    return left_out;
  }

  // ---- triangles and samples ---------------------------------------------------------------------------

  struct RightAngle {
    std::size_t corner;
    std::int64_t longest;  ///< squared length of the longest side
  };
  static RightAngle right_angle_of(const std::array<GridPoint, 3>& corners) {
    RightAngle found{0, -1};
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint a = corners[(i + 1) % 3], b = corners[(i + 2) % 3];
      const std::int64_t dc = std::int64_t{a.col} - b.col, dr = std::int64_t{a.row} - b.row;
      if (dc * dc + dr * dr > found.longest) found = {i, dc * dc + dr * dr};
    }
    return found;
  }
  static HalfDiamond half_over(const std::array<GridPoint, 3>& corners, std::size_t apex) {
    const GridPoint middle = midpoint(corners[(apex + 1) % 3], corners[(apex + 2) % 3]);
    return half_diamond(middle, diamond(middle).apexes[0] == corners[apex] ? 0 : 1);
  }

  /// The quadtree of the chosen vertices.
  [[nodiscard]] RestrictedQuadtree quadtree() {
    close_bottom_up(chosen_, root_);
    // Beside voids, no triangle may need some of the vertices that others depend on.
    for (std::int64_t row = region_.first.row; row <= region_.last.row; ++row) {
      const auto to = chosen_.row_words(static_cast<std::int32_t>(row));
      const auto all = std::as_const(finest_.quadtree.vertices).row_words(static_cast<std::int32_t>(row));
      for (std::size_t w = 0; w < to.size(); ++w) to[w] &= all[w];
    }
    chosen_.seal();
    watch_.require_vertices(chosen_.size());  // chosen vertices stay
    const RestrictedQuadtree& f = finest_.quadtree;
    RestrictedQuadtree q;
    q.region = f.region;
    q.vertices = chosen_;
    q.heights.resize(chosen_.size());
    if (!f.covers.empty()) q.covers.resize(chosen_.size());
    std::size_t i = 0;
    chosen_.for_each([&](GridPoint p) {
      const std::uint32_t from = f.vertices.rank(p);
      q.heights[i] = f.heights[from];
      if (!f.covers.empty()) q.covers[i] = f.covers[from];
      ++i;
    });
    return q;
  }

  /// Returns whether a triangle was split.
  bool split_once() {
    const Mesh mesh = triangulate(quadtree(), 1);
    std::vector<GridPoint> more;
    for (const auto& t : mesh.triangles) {
      watch_.look();
      const std::array<GridPoint, 3> corners{mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
      const std::array<double, 3> heights{mesh.heights[t[0]], mesh.heights[t[1]], mesh.heights[t[2]]};
      if (const auto middle = check(corners, heights)) more.push_back(*middle);
    }
    for (const GridPoint p : more) chosen_.insert(p);
    left_ *= 0.7;  // the number of rounds is unknown
    watch_.tell(1 - left_);
    return !more.empty();
  }

  /// The vertex at which a triangle must be split, if any.
  std::optional<GridPoint> check(const std::array<GridPoint, 3>& corners, const std::array<double, 3>& heights) {
    const auto [apex, longest] = right_angle_of(corners);
    if (longest <= 2) {  // half a cell: its corners are its samples
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t at = samples_.index(corners[i]);
        if (samples_.valid[at] != 0) farthest_ = std::max(farthest_, std::abs(samples_.values[at] - heights[i]));
      }
      return std::nullopt;
    }
    const HalfDiamond half = half_over(corners, apex);
    const GridPoint middle = half.vertex;
    const int side = diamond(middle).apexes[0] == half.apex ? 0 : 1;
    if (checked_.has(middle, side)) return std::nullopt;
    const auto height_at = [&](GridPoint p) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (corners[i] == p) return heights[i];
      }
      return heights[0];
    };
    const auto found = farthest(half, plane_of(half, height_at));
    const bool may_split = may_have(middle);
    if (may_split && (!(found.distance <= limit_) || (found.has_void && for_its_voids_->contains(middle))))
      return middle;
    farthest_ = std::max(farthest_, found.distance);
    checked_.insert(middle, side);
    return std::nullopt;
  }

  struct Found {
    double distance = 0;
    bool has_void = false;
  };
  /// The largest distance of the triangle's valid samples; stops at the first one that is too far.
  [[nodiscard]] Found farthest(const HalfDiamond& t, const Plane<double>& plane) const {
    Found found;
    for (std::int32_t row = t.top(); row <= t.bottom(); ++row) {
      const HalfDiamond::Columns columns = t.columns(row);
      const double start = plane.on_row(row);
      const std::size_t base = samples_.index({columns.lo, row});
      const double* values = samples_.values.data() + base;
      const auto count = static_cast<std::size_t>(columns.hi - columns.lo + 1);
      double largest = found.distance;
      if (!has_voids_) {
        for (std::size_t i = 0; i < count; ++i) {
          const double at =
              start + plane.right * static_cast<double>(columns.lo + static_cast<std::int32_t>(i) - plane.col);
          largest = std::max(largest, std::abs(values[i] - at));
        }
      } else {
        const std::uint8_t* valid = samples_.valid.data() + base;
        for (std::size_t i = 0; i < count; ++i) {
          const double at =
              start + plane.right * static_cast<double>(columns.lo + static_cast<std::int32_t>(i) - plane.col);
          if (valid[i] == 0) {
            found.has_void = true;
          } else {
            largest = std::max(largest, std::abs(values[i] - at));
          }
        }
      }
      found.distance = largest;
      if (found.distance > limit_) break;
    }
    return found;
  }

  Answer answer() {
    Answer made;
    RestrictedQuadtree& q = made.quadtree;
    q = quadtree();
    if (std::all_of(q.covers.begin(), q.covers.end(), [](std::uint8_t c) { return c == 15; })) q.covers.clear();
    const RestrictedQuadtree& f = finest_.quadtree;
    const double unit = description_.metres_per_unit;
    const bool rounds =
        !CodeDistance(description_.step, unit).is_binary() || !description_.step.integer || !rounded_.is_exact();
    q.bound = Metres{farthest_ * unit + description_.lossy.value + (rounds && farthest_ > 0 ? kRoundingMargin : 0.0)};
    q.origin = f.origin;
    q.origin.is_plain = false;
    // Without finer levels, each triangle is one that was checked, or one without a midpoint.
    VertexMask needed(region_);
    for (const GridPoint p : border_vertices(region_, root_)) needed.insert(p);
    std::vector<bool> has_vertices(f.level_errors.size());
    q.vertices.for_each([&](GridPoint p) {
      if (!needed.contains(p))
        has_vertices[std::min(static_cast<std::size_t>(height_in_tree(p)), has_vertices.size() - 1)] = true;
    });
    q.level_errors.assign(f.level_errors.size(), 0);
    for (std::size_t i = 0; i < q.level_errors.size(); ++i) {
      if (has_vertices[i]) q.level_errors[i] = f.level_errors[i];
    }
    made.border_vertices = finest_.border_vertices;
    made.cost = finest_.cost;
    return made;
  }

  const RoundedQuestion& question_;
  Metres quantum_;
  bool fits_;
  const Description& description_ = question_.pages.manifest().description;
  Watch& watch_ = question_.watch;
  double left_ = 1;  ///< share of the work that is left, for progress
  SampleWindow samples_ = samples_for(question_, fits_);
  /// All triangles may hold data, and some a void all the same.
  bool has_voids_ = std::find(samples_.valid.begin(), samples_.valid.end(), 0) != samples_.valid.end();
  GridRect region_ = question_.region;
  std::int32_t root_ = root_side(description_.extent);
  /// In the vertical unit.
  double limit_ = (question_.tolerance.value - description_.lossy.value) / description_.metres_per_unit;
  Answer finest_ = exact_answer(
      question_, fits_ ? Metres{0} : Metres{question_.tolerance.value - rounding_of(description_, quantum_)});
  Rounding rounded_{description_, quantum_};
  std::optional<VertexMask> for_its_voids_;
  VertexMask sides_, coarse_;             // these and the following: for fitted heights
  std::vector<double> sources_, fitted_;  // heights by rank in `finest`
  std::vector<std::uint8_t> is_fixed_;
  VertexMask chosen_{region_};
  Checked checked_{region_};
  double farthest_ = 0;  ///< over the triangles that stay; in the vertical unit
};

}  // namespace

Answer split_answer(const RoundedQuestion& question, Metres quantum, SplitHeights heights) {
  return Splitter(question, quantum, heights).run();
}

}  // namespace talus
