#include "query/bounded/bounded_heights.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "engine/error/height_field.hpp"
#include "engine/machine/fail.hpp"
#include "query/bounded/splitter.hpp"
#include "query/selection/range_query.hpp"
#include "query/selection/refusals.hpp"

namespace talus {
namespace {

double step_metres(const Description& d) { return std::abs(d.step.scale) / d.step.divisor * d.metres_per_unit; }

/// Whether all heights of answers are. In a database of a tolerance, those that were dropped are means of others.
bool are_whole_steps(const Description& d) {
  return d.step.integer && d.step.offset == 0 && d.finest_tolerance.value == 0;
}

/// The number of height steps in a quantum; empty if it is not whole, or heights are not.
std::optional<double> steps_in(const Description& d, Metres quantum) {
  if (!are_whole_steps(d)) return std::nullopt;
  const double steps = quantum.value / step_metres(d), whole = std::nearbyint(steps);
  if (whole < 1 || std::abs(steps - whole) > 1e-9 * whole) return std::nullopt;
  return whole;
}

void require_quantum(const Description& d, Metres quantum) {
  if (d.error_metric != ErrorMetric::vertical)
    refuse(
        "rounded heights need errors along the vertical, this database has perpendicular ones: ask for exact heights");
  if (!(quantum.value > 0) || !std::isfinite(quantum.value))
    refuse("quantum {} m: expected a finite number of metres above 0", quantum.value);
  // Larger multiples are not exact in doubles and streams.
  constexpr double kMostQuanta = 1e15;
  const double largest_m = std::max(std::abs(d.minimum_height), std::abs(d.maximum_height)) * d.metres_per_unit;
  if (largest_m / kMostQuanta > quantum.value) {
    refuse("quantum {} m: heights reach {} m, which is more than {} multiples of it. Choose a larger quantum",
           quantum.value, largest_m, kMostQuanta);
  }
}

/// Refuses a quantum whose rounding exceeds the tolerance.
void require_quantum(const Description& d, Metres tolerance, Metres quantum) {
  require_quantum(d, quantum);
  const double off = rounding_of(d, quantum);
  const bool keeps_all = d.kept_above().value == 0;
  if (off > tolerance.value - (keeps_all ? d.lossy : d.finest_tolerance).value) {
    const std::string before =
        !keeps_all          ? fmt::format(", and ingest kept only the vertices for {} m", d.finest_tolerance.value)
        : d.lossy.value > 0 ? fmt::format(", and ingest has rounded heights by up to {} m already", d.lossy.value)
                            : "";
    refuse(
        "multiples of {} m can lie {} m from a height{}: more than the tolerance of {} m. Choose a smaller quantum or "
        "a larger tolerance",
        quantum.value, off, before, tolerance.value);
  }
}

/// Rounds the heights of an answer, and adds the rounding to its errors and its bound.
void round_heights(RestrictedQuadtree& q, const Description& d, Metres quantum) {
  const Rounding rounded(d, quantum);
  const double off = rounding_of(d, quantum) + (rounded.is_exact() ? 0 : kRoundingMargin);
  for (double& h : q.heights) h = rounded(h);
  q.bound = Metres{q.bound.value + off};
  for (double& error : q.level_errors) error = error > 0 ? error + off : 0;
  q.origin.quantum = quantum;
}

Answer rounded_range(const RoundedQuestion& q, Metres quantum) {
  const Description& d = q.pages.manifest().description;
  const double off = rounding_of(d, quantum);
  std::optional<Metres> from;
  if (q.from) from = Metres{q.from->value - off};
  const Metres to{q.tolerance.value - off};
  if (from) {
    require_tolerance(*from);
    require_tolerance(to);
    require_finer(*from, to);
  }
  Answer answer = range_query(q.pages, q.region, to, q.threads, from, q.watch);
  answer.from = q.from;
  answer.quadtree.tolerance = q.tolerance;
  round_heights(answer.quadtree, d, quantum);
  return answer;
}

/// Sets the facts of an answer whose corners may lie `off` metres off the source's heights.
void finish(RestrictedQuadtree& q, Metres tolerance, Metres quantum, double off) {
  q.tolerance = tolerance;
  q.origin.quantum = quantum;
  for (double& error : q.level_errors) error = error > 0 ? error + off : 0;
}

/// What is compared with every sample needs them all.
void require_all_samples(const Description& d, const char* heights) {
  if (d.kept_above().value == 0) return;
  fail(Cause::unsupported,
       "{} heights are compared with every sample, and ingest kept only the vertices for {} m: ask for exact or dense "
       "heights, or for bounded ones with a Heights::quantum",
       heights, d.finest_tolerance.value);
}

void require_some_tolerance(const Description& d, Metres tolerance, const char* heights) {
  if (tolerance.value == 0 || !std::isfinite(tolerance.value))
    refuse("{} heights at a tolerance of {} m: expected a finite tolerance above 0", heights, tolerance.value);
  if (tolerance.value <= d.lossy.value) {
    refuse(
        "{} heights at a tolerance of {} m: ingest has rounded heights by up to {} m already. Choose a larger "
        "tolerance, or exact heights",
        heights, tolerance.value, d.lossy.value);
  }
}

}  // namespace

double rounding_of(const Description& d, Metres quantum) {
  if (const auto steps = steps_in(d, quantum)) return std::floor(*steps / 2) * step_metres(d);
  return quantum.value / 2;
}

Metres quantum_for(const Description& d, Metres tolerance) {
  if (!are_whole_steps(d)) return tolerance;
  double steps = std::max(1.0, std::floor(tolerance.value / step_metres(d)));
  if (std::fmod(steps, 2) == 0) ++steps;  // a larger quantum with the same rounding
  return Metres{steps * step_metres(d)};
}

Metres dense_quantum(const Description& d, Metres tolerance) {
  const double left = std::max(0.0, tolerance.value - std::max(d.lossy.value, d.finest_tolerance.value));
  if (!are_whole_steps(d)) return Metres{2 * left};
  return Metres{(2 * std::floor(left / step_metres(d)) + 1) * step_metres(d)};
}

namespace {

/// Rounds the exact answer at the tolerance minus the rounding. Increments of the same quantum go on from it.
Answer nested(const RoundedQuestion& q, Metres quantum) {
  require_quantum(q.pages.manifest().description, q.tolerance, quantum);
  return rounded_range(q, quantum);
}

Answer dense(const RoundedQuestion& q) {
  const Description& d = q.pages.manifest().description;
  if (q.tolerance.value == 0 || !std::isfinite(q.tolerance.value))
    refuse("dense heights at a tolerance of {} m: expected a finite tolerance above 0", q.tolerance.value);
  const Metres quantum = dense_quantum(d, q.tolerance);
  if (!(quantum.value > 0)) return range_query(q.pages, q.region, q.tolerance, q.threads, {}, q.watch);
  require_quantum(d, quantum);
  return rounded_range(q, quantum);
}

Answer bounded(const RoundedQuestion& q, Metres quantum) {
  const Description& d = q.pages.manifest().description;
  require_all_samples(d, "bounded");
  require_some_tolerance(d, q.tolerance, "bounded");
  require_quantum(d, q.tolerance, quantum);
  Answer answer = split_answer(q, quantum, SplitHeights::rounded);
  if (!(answer.quadtree.bound.value <= q.tolerance.value + 2 * kRoundingMargin)) return rounded_range(q, quantum);
  finish(answer.quadtree, q.tolerance, quantum, rounding_of(d, quantum));
  return answer;
}

Answer fitted(const RoundedQuestion& q, Metres quantum) {
  const Description& d = q.pages.manifest().description;
  require_all_samples(d, "fitted");
  require_some_tolerance(d, q.tolerance, "fitted");
  // A finer quantum needs fewer vertices, but more bits for each: docs/accuracy.md.
  if (quantum.value == 0) quantum = Metres{(q.tolerance.value - d.lossy.value) / 2};
  require_quantum(d, q.tolerance, quantum);
  Answer answer = split_answer(q, quantum, SplitHeights::fitted);
  if (!(answer.quadtree.bound.value <= q.tolerance.value + 2 * kRoundingMargin)) return bounded(q, quantum);
  finish(answer.quadtree, q.tolerance, quantum, q.tolerance.value);
  return answer;
}

}  // namespace

Answer rounded_answer(const RoundedQuestion& q, Heights heights) {
  if (heights.kind == HeightKind::dense) return dense(q);
  if (heights.kind == HeightKind::fitted) return fitted(q, heights.quantum);
  if (heights.quantum.value != 0) return nested(q, heights.quantum);
  return bounded(q, quantum_for(q.pages.manifest().description, q.tolerance));
}

}  // namespace talus
