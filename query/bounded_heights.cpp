#include "query/bounded_heights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/border.hpp"
#include "engine/construction.hpp"
#include "engine/half_diamond.hpp"
#include "engine/height_field.hpp"
#include "query/stopwatch.hpp"

namespace talus {
namespace {

[[noreturn]] void refuse(std::string sentence) { throw Failure(Cause::invalid_argument, std::move(sentence)); }

double step_metres(const Description& d) { return std::abs(d.step.scale) / d.step.divisor * d.metres_per_unit; }

/// How many height steps a quantum is, if a whole number.
std::optional<double> steps_in(const Description& d, Metres quantum) {
  if (!d.step.integer || d.step.offset != 0) return std::nullopt;
  const double steps = quantum.value / step_metres(d), whole = std::nearbyint(steps);
  if (whole < 1 || std::abs(steps - whole) > 1e-9 * whole) return std::nullopt;
  return whole;
}

void require_quantum(const Description& d, Metres tolerance, Metres quantum) {
  if (!d.has_vertical_bound()) {
    refuse(fmt::format("rounded heights need errors that bound distances along the vertical, this database has {} {} ones: ask "
                       "for exact heights", name_of(d.error_metric), name_of(d.error_kind)));
  }
  if (!(quantum.value > 0) || !std::isfinite(quantum.value))
    refuse(fmt::format("quantum {} m: expected a number of metres above 0", quantum.value));
  // Larger multiples are no whole numbers in doubles, nor in streams.
  constexpr double kMostQuanta = 1e15;
  const double largest_m = std::max(std::abs(d.minimum), std::abs(d.maximum)) * d.metres_per_unit;
  if (largest_m / kMostQuanta > quantum.value) {
    refuse(fmt::format("quantum {} m: heights reach {} m, which is more than {} multiples of it: expected a larger one",
                       quantum.value, largest_m, kMostQuanta));
  }
  if (rounding_of(d, quantum) > tolerance.value) {
    refuse(fmt::format("multiples of {} m can lie {} m from a height, more than the tolerance of {} m: expected a smaller quantum",
                       quantum.value, rounding_of(d, quantum), tolerance.value));
  }
}

class Rounding {
 public:
  Rounding(const Description& d, Metres quantum) : unit_(quantum.value / d.metres_per_unit) {}
  [[nodiscard]] double operator()(double height) const { return (std::nearbyint(height / unit_) + 0.0) * unit_; }

 private:
  double unit_;
};

/// The same vertices at rounded heights; what it costs is added to all that is said of errors.
void round_heights(RestrictedQuadtree& q, const Description& d, Metres quantum) {
  const Rounding rounded(d, quantum);
  const double off = rounding_of(d, quantum);
  for (double& h : q.heights) h = rounded(h);
  q.bound = Metres{q.bound.value + off};
  for (double& error : q.level_errors) error = error > 0 ? error + off : 0;
  q.origin.quantum = quantum;
}

/// Triangles that were held against the samples under them, one bit for each half of a diamond.
class Checked {
 public:
  explicit Checked(GridRect region) : halves_{VertexMask(region), VertexMask(region)} {}
  [[nodiscard]] bool has(GridPoint middle, int side) const { return halves_[static_cast<std::size_t>(side)].contains(middle); }
  void insert(GridPoint middle, int side) { halves_[static_cast<std::size_t>(side)].insert(middle); }

 private:
  std::array<VertexMask, 2> halves_;
};

/// Splits triangles, from the coarsest on, that leave a sample out, until none does.
///
/// Every vertex that this may need is in `finest`, the answer at the tolerance less the rounding: if a triangle with rounded
/// heights is too far from a sample, then with exact ones it is farther than that, so the error of its midpoint is larger; and
/// errors are saturated, so all that the midpoint depends on is selected, too. On the region's sides all of `finest` is
/// taken: neighbours then have the same vertices there, whatever lies beyond.
class Splitter {
 public:
  Splitter(const Snapshot& now, GridRect region, Metres tolerance, Metres quantum)
      : description_(now.description()),
        samples_(now.samples(region)),
        region_(region),
        root_(root_side(description_.extent)),
        limit_((tolerance.value - description_.lossy_metres) / description_.metres_per_unit),
        finest_(now.range(region, Metres{tolerance.value - rounding_of(description_, quantum)})),
        rounded_(description_, quantum),
        chosen_(region),
        checked_(region) {
    // A triangle that mixes data and void may have to go for its size: the answer at the tolerance says so.
    if (!finest_.quadtree.covers.empty()) {
      Answer exact = now.range(region, tolerance);
      finest_.cost.pages_read += exact.cost.pages_read;
      finest_.cost.bytes_read += exact.cost.bytes_read;
      finest_.cost.pages_cached += exact.cost.pages_cached;
      for_its_voids_ = std::move(exact.quadtree.vertices);
    }
    for (double& h : finest_.quadtree.heights) h = rounded_(h);
  }

  Answer run() {
    const Stopwatch running(finest_.cost.seconds);
    const VertexMask& all = finest_.quadtree.vertices;
    for (const GridPoint p : border_vertices(region_, root_)) insert(p);
    const GridPoint first = region_.first, last = region_.last;
    all.for_each([&](GridPoint p) {
      const bool on_side = p.col == first.col || p.col == last.col || p.row == first.row || p.row == last.row;
      if (on_side || spacing(p) >= root_) insert(p);
    });
    while (split_once()) {
    }
    return answer();
  }

 private:
  void insert(GridPoint p) {
    if (finest_.quadtree.vertices.contains(p)) chosen_.insert(p);
  }

  /// The quadtree of what is chosen so far.
  [[nodiscard]] RestrictedQuadtree quadtree() {
    close_bottom_up(chosen_, root_);
    // Amid voids no triangle needs all that a vertex depends on.
    for (std::int64_t row = region_.first.row; row <= region_.last.row; ++row) {
      const auto to = chosen_.row_words(static_cast<std::int32_t>(row));
      const auto all = std::as_const(finest_.quadtree.vertices).row_words(static_cast<std::int32_t>(row));
      for (std::size_t w = 0; w < to.size(); ++w) to[w] &= all[w];
    }
    chosen_.seal();
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

  /// Returns whether anything had to be split.
  bool split_once() {
    const Mesh mesh = triangulate(quadtree());
    std::vector<GridPoint> more;
    for (const auto& t : mesh.triangles) {
      const std::array<GridPoint, 3> corners{mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
      const std::array<double, 3> heights{mesh.heights[t[0]], mesh.heights[t[1]], mesh.heights[t[2]]};
      if (const auto middle = check(corners, heights)) more.push_back(*middle);
    }
    for (const GridPoint p : more) chosen_.insert(p);
    return !more.empty();
  }

  /// The vertex that a triangle is to be split at, if it has to be.
  std::optional<GridPoint> check(const std::array<GridPoint, 3>& corners, const std::array<double, 3>& heights) {
    std::size_t apex = 0;
    std::int64_t longest = -1;
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint a = corners[(i + 1) % 3], b = corners[(i + 2) % 3];
      const std::int64_t dc = std::int64_t{a.col} - b.col, dr = std::int64_t{a.row} - b.row;
      if (dc * dc + dr * dr > longest) longest = dc * dc + dr * dr, apex = i;
    }
    if (longest <= 2) {  // half a cell: its corners are its samples
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t at = samples_.index(corners[i]);
        if (samples_.valid[at] != 0) farthest_ = std::max(farthest_, std::abs(samples_.values[at] - heights[i]));
      }
      return std::nullopt;
    }
    const GridPoint a = corners[(apex + 1) % 3], b = corners[(apex + 2) % 3], middle = midpoint(a, b);
    const Diamond d = diamond(middle);
    const int side = d.apexes[0] == corners[apex] ? 0 : 1;
    if (checked_.has(middle, side)) return std::nullopt;
    const HalfDiamond half = half_diamond(middle, side);
    const auto height_at = [&](GridPoint p) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (corners[i] == p) return heights[i];
      }
      return heights[0];
    };
    const auto found = farthest(half, plane_of(half, height_at));
    const bool may_split = finest_.quadtree.vertices.contains(middle);
    if (may_split && (!(found.distance <= limit_) || (found.has_void && for_its_voids_->contains(middle)))) return middle;
    farthest_ = std::max(farthest_, found.distance);
    checked_.insert(middle, side);
    return std::nullopt;
  }

  struct Found {
    double distance = 0;
    bool has_void = false;
  };
  /// Over the valid samples of a triangle; what it says is too far once one sample is.
  [[nodiscard]] Found farthest(const HalfDiamond& t, const Plane<double>& plane) const {
    Found found;
    const bool no_voids = finest_.quadtree.covers.empty();
    for (std::int32_t row = t.top(); row <= t.bottom(); ++row) {
      const HalfDiamond::Columns columns = t.columns(row);
      const double start = plane.on_row(row);
      const std::size_t base = samples_.index({columns.lo, row});
      const double* values = samples_.values.data() + base;
      const auto count = static_cast<std::size_t>(columns.hi - columns.lo + 1);
      double largest = found.distance;
      if (no_voids) {
        for (std::size_t i = 0; i < count; ++i) {
          const double at = start + plane.right * static_cast<double>(columns.lo + static_cast<std::int32_t>(i) - plane.col);
          largest = std::max(largest, std::abs(values[i] - at));
        }
      } else {
        const std::uint8_t* valid = samples_.valid.data() + base;
        for (std::size_t i = 0; i < count; ++i) {
          const double at = start + plane.right * static_cast<double>(columns.lo + static_cast<std::int32_t>(i) - plane.col);
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
    const bool rounds = !CodeDistance(description_.step, unit).is_binary();
    q.bound = Metres{farthest_ * unit + description_.lossy_metres + (rounds && farthest_ > 0 ? kRoundingMargin : 0.0)};
    q.origin = f.origin;
    q.origin.is_plain = false;
    // Without its finer levels each triangle is one that was held against its samples, or one whose midpoint is gone.
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

  const Description& description_;
  SampleWindow samples_;
  GridRect region_;
  std::int32_t root_;
  double limit_;  ///< vertical unit
  Answer finest_;
  Rounding rounded_;
  std::optional<VertexMask> for_its_voids_;
  VertexMask chosen_;
  Checked checked_;
  double farthest_ = 0;  ///< of the triangles that stay; vertical unit
};

}  // namespace

double rounding_of(const Description& d, Metres quantum) {
  if (const auto steps = steps_in(d, quantum)) return std::floor(*steps / 2) * step_metres(d);
  return quantum.value / 2;
}

Metres quantum_for(const Description& d, Metres tolerance) {
  if (!d.step.integer || d.step.offset != 0) return tolerance;
  double steps = std::max(1.0, std::floor(tolerance.value / step_metres(d)));
  if (std::fmod(steps, 2) == 0) ++steps;  // rounds no farther
  return Metres{steps * step_metres(d)};
}

Metres dense_quantum(const Description& d, Metres tolerance) {
  const double left = std::max(0.0, tolerance.value - std::max(d.lossy_metres, d.finest_tolerance));
  if (!d.step.integer || d.step.offset != 0) return Metres{2 * left};
  return Metres{(2 * std::floor(left / step_metres(d)) + 1) * step_metres(d)};
}

Answer quantised_answer(const Snapshot& now, GridRect region, Metres tolerance, Metres quantum) {
  const Description& d = now.description();
  require_quantum(d, tolerance, quantum);
  Answer answer = now.range(region, Metres{tolerance.value - rounding_of(d, quantum)});
  answer.quadtree.tolerance = tolerance;
  round_heights(answer.quadtree, d, quantum);
  return answer;
}

Increment quantised_increment(const Snapshot& now, GridRect region, Metres from, Metres to, Metres quantum) {
  const Description& d = now.description();
  require_quantum(d, to, quantum);
  const double off = rounding_of(d, quantum);
  Increment increment = now.increment(region, Metres{from.value - off}, Metres{to.value - off});
  increment.from = from;
  increment.added.tolerance = to;
  round_heights(increment.added, d, quantum);
  return increment;
}

Answer dense_answer(const Snapshot& now, GridRect region, Metres tolerance) {
  if (tolerance.value == 0 || !std::isfinite(tolerance.value))
    refuse(fmt::format("dense heights at a tolerance of {} m: expected one above 0 and finite", tolerance.value));
  const Metres quantum = dense_quantum(now.description(), tolerance);
  return quantum.value > 0 ? quantised_answer(now, region, tolerance, quantum) : now.range(region, tolerance);
}

Answer bounded_answer(const Snapshot& now, GridRect region, Metres tolerance, Metres quantum) {
  const Description& d = now.description();
  if (quantum.value == 0) quantum = quantum_for(d, tolerance);
  if (tolerance.value == 0 || !std::isfinite(tolerance.value))
    refuse(fmt::format("bounded heights at a tolerance of {} m: expected one above 0 and finite", tolerance.value));
  require_quantum(d, Metres{tolerance.value - d.lossy_metres}, quantum);
  Answer answer = Splitter(now, region, tolerance, quantum).run();
  RestrictedQuadtree& q = answer.quadtree;
  if (!(q.bound.value <= tolerance.value + 2 * kRoundingMargin)) return quantised_answer(now, region, tolerance, quantum);
  q.tolerance = tolerance;
  q.origin.quantum = quantum;
  const double off = rounding_of(d, quantum);
  for (double& error : q.level_errors) error = error > 0 ? error + off : 0;
  return answer;
}

}  // namespace talus
