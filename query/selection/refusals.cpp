#include "query/selection/refusals.hpp"

#include <algorithm>
#include <bit>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/grid.hpp"
#include "query/pages/placed_rectangle.hpp"
#include "query/selection/combinations.hpp"
#include "query/selection/matching.hpp"

namespace talus {

int finest_level(GridRect extent) {
  return std::max(0, std::countr_zero(static_cast<std::uint32_t>(root_side(extent))) - 1);
}

void require_inside(const StoredPages& pages, GridRect region) {
  const GridRect& extent = pages.manifest().description.extent;
  if (is_empty(region) || !extent.contains(region.first) || !extent.contains(region.last)) {
    refuse("region of columns {} to {}, rows {} to {}: it must lie within columns {} to {}, rows {} to {}",
           region.first.col, region.last.col, region.first.row, region.last.row, extent.first.col, extent.last.col,
           extent.first.row, extent.last.row);
  }
}

void require_tolerance(Metres tolerance) {
  if (!(tolerance.value >= 0)) refuse("tolerance {} m: expected a number of metres, 0 or more", tolerance.value);
}

namespace {

void require_neighbour(const StoredPages& pages, GridRect region, const RestrictedQuadtree& neighbour) {
  if (neighbour.origin.identity != pages.identity())
    refuse("a neighbour's answer is from another database, or from another state of it: ask for it again");
  if (neighbour.origin.border != Border::constrain)
    refuse("a neighbour's answer has another border than constrain: ask for it again with a constrained border");
  const GridRect& other = neighbour.region;
  if (!(neighbour.vertices.region() == other)) refuse("a neighbour's vertices cover another region than its own");
  if (shared_side(region, other)) return;
  refuse(
      "the neighbour of columns {} to {}, rows {} to {} shares no side with the region of columns {} to {}, rows {} to "
      "{}",
      other.first.col, other.last.col, other.first.row, other.last.row, region.first.col, region.last.col,
      region.first.row, region.last.row);
}

}  // namespace

bool asks_for(const Question& q, Feature feature, bool together) {
  const HeightKind kind = q.heights.kind;
  switch (feature) {
    case Feature::region: return !(q.region == Question{}.region);
    case Feature::rectangle: return q.rectangle.has_value();
    case Feature::tolerance: return q.tolerance.value > 0;
    case Feature::budget: return q.budget.vertices > 0 || q.budget.triangles > 0;
    case Feature::field: return q.field != nullptr;
    case Feature::from: return q.from.has_value();
    case Feature::border: return q.border != Border::constrain;
    case Feature::exact: return kind == HeightKind::exact;
    case Feature::bounded_alone: return kind == HeightKind::bounded && q.heights.quantum.value == 0;
    case Feature::fitted: return kind == HeightKind::fitted;
    case Feature::dense: return kind == HeightKind::dense;
    case Feature::rounded: return kind != HeightKind::exact;
    case Feature::quantum: return q.heights.quantum.value != 0;
    case Feature::max_level: return q.max_level.has_value();
    case Feature::points: return !q.points.empty() || !q.places.empty() || !q.lines.empty();
    case Feature::neighbours: return !q.neighbours.empty();
    case Feature::together: return together;
  }
  return false;
}

namespace {

void require_combinable(const Question& question, bool together) {
  for (const Combination& pair : kRefused) {
    if (asks_for(question, pair.one, together) && asks_for(question, pair.other, together)) refuse("{}", pair.sentence);
  }
}

void require_from(const Question& question) {
  require_tolerance(*question.from);
  if (asks_for(question, Feature::budget, false)) return;  // the tolerance is not known yet
  require_finer(*question.from, question.tolerance);
}

}  // namespace

void require_finer(Metres from, Metres to) {
  if (to < from) return;
  refuse(
      "increment from {} m to {} m: the second must be smaller; lower Question::tolerance (or allow more with "
      "Question::budget), or raise Question::from",
      from.value, to.value);
}

void require_combinable(const Question& question) { require_combinable(question, false); }

Question accepted(const StoredPages& pages, const Question& asked, bool together) {
  require_combinable(asked, together);
  const Description& d = pages.manifest().description;
  Question question = asked;
  if (asked.rectangle) {
    question.region = placed(*asked.rectangle, d, pages.longitudes()).samples;
    question.rectangle.reset();
  } else if (!asks_for(asked, Feature::region, together)) {
    question.region = d.extent;
  }
  require_inside(pages, question.region);
  require_tolerance(question.tolerance);
  if (question.threads < 0) refuse("{} threads: expected 0 or more", question.threads);
  if (question.max_level && *question.max_level < 0)
    refuse("finest level {}: expected 0 or more for Question::max_level", *question.max_level);
  if (question.from) require_from(question);
  const std::vector<GridPoint> nearest = samples_nearest(d, question.region, question.places);
  question.points.insert(question.points.end(), nearest.begin(), nearest.end());
  if (!question.lines.empty()) {
    const std::vector<GridPoint> along = samples_along(d, question.region, question.lines);
    question.points.insert(question.points.end(), along.begin(), along.end());
  }
  question.places.clear();
  question.lines.clear();
  for (const GridPoint p : question.points) {
    if (question.region.contains(p)) continue;
    refuse("point of interest at column {}, row {}: expected a point in the region, columns {} to {}, rows {} to {}",
           p.col, p.row, question.region.first.col, question.region.last.col, question.region.first.row,
           question.region.last.row);
  }
  for (const RestrictedQuadtree* neighbour : question.neighbours) require_neighbour(pages, question.region, *neighbour);
  return question;
}

}  // namespace talus
