#include "query/selection/refusals.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/geo/ground.hpp"
#include "engine/geo/longitude.hpp"
#include "engine/quadtree/grid.hpp"
#include "query/pages/placed_rectangle.hpp"
#include "query/selection/combinations.hpp"
#include "query/selection/matching.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

[[noreturn]] void refuse(std::string sentence) { throw Failure(Cause::invalid_argument, std::move(sentence)); }

class FocusTolerance final : public ToleranceField {
 public:
  FocusTolerance(double col, double row, double metres_per_col, double metres_per_row, double growth, double at_focus)
      : col_(col), row_(row), right_(metres_per_col), down_(metres_per_row), growth_(growth), at_focus_(at_focus) {}

  [[nodiscard]] Metres at(GridPoint p) const override { return of(p.col - col_, p.row - row_); }
  /// The tolerance at the rectangle's nearest point, which need not be a sample.
  [[nodiscard]] Metres least(GridRect r) const override {
    return of(std::clamp(col_, double(r.first.col), double(r.last.col)) - col_,
              std::clamp(row_, double(r.first.row), double(r.last.row)) - row_);
  }

 private:
  [[nodiscard]] Metres of(double cols, double rows) const {
    return Metres{at_focus_ + growth_ * std::hypot(cols * right_, rows * down_)};
  }
  double col_, row_, right_, down_, growth_, at_focus_;
};

}  // namespace

std::shared_ptr<const ToleranceField> focus_tolerance(const Description& d, double asked_x, double y,
                                                      double metres_per_metre, Metres at_focus) {
  require_tolerance(at_focus);
  const double x = Longitudes(d).among(Position{asked_x, y}, d.extent).x;
  if (!std::isfinite(x) || !std::isfinite(y)) refuse(fmt::format("focus {}, {}: expected two finite numbers", x, y));
  if (!(metres_per_metre >= 0) || !std::isfinite(metres_per_metre))
    refuse(fmt::format("tolerance that grows by {} m a metre: expected 0 or more", metres_per_metre));
  const double col = (x - d.mapping.x0) / d.mapping.dx, row = (y - d.mapping.y0) / d.mapping.dy;
  const GridRect& e = d.extent;
  if (!(col >= e.first.col - 0.5 && col <= e.last.col + 0.5 && row >= e.first.row - 0.5 && row <= e.last.row + 0.5)) {
    refuse(fmt::format(
        "focus {}, {} lies outside the raster, whose samples span {},{},{},{}; X comes before Y, in the "
        "database's CRS",
        x, y, d.mapping.x(e.first.col), d.mapping.y(e.last.row), d.mapping.x(e.last.col), d.mapping.y(e.first.row)));
  }
  const Ground ground(d.crs);
  const double right = ground.metres({x, y}, {x + d.mapping.dx, y}),
               down = ground.metres({x, y}, {x, y + d.mapping.dy});
  if (!(right > 0) || !(down > 0))
    refuse(fmt::format("focus {}, {}: cells have no size there; X comes before Y, in the database's CRS", x, y));
  return std::make_shared<FocusTolerance>(col, row, right, down, metres_per_metre, at_focus.value);
}

GridRect snapped(GridRect region, std::int32_t samples, GridRect extent) {
  if (samples < 1) refuse(fmt::format("snap to multiples of {} samples: expected 1 or more", samples));
  const auto down = [&](std::int64_t v) { return v - ((v % samples) + samples) % samples; };
  const auto up = [&](std::int64_t v) { return -down(-v); };
  const auto within = [](std::int64_t v, std::int32_t first, std::int32_t last) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, first, last));
  };
  return {{within(down(region.first.col), extent.first.col, extent.last.col),
           within(down(region.first.row), extent.first.row, extent.last.row)},
          {within(up(region.last.col), extent.first.col, extent.last.col),
           within(up(region.last.row), extent.first.row, extent.last.row)}};
}

int finest_level(GridRect extent) {
  return std::max(0, std::countr_zero(static_cast<std::uint32_t>(root_side(extent))) - 1);
}

void require_inside(const StoredPages& pages, GridRect region) {
  const GridRect& extent = pages.manifest().description.extent;
  if (region.cols() < 1 || region.rows() < 1 || !extent.contains(region.first) || !extent.contains(region.last)) {
    refuse(fmt::format("region of columns {} to {}, rows {} to {}: it must lie within columns {} to {}, rows {} to {}",
                       region.first.col, region.last.col, region.first.row, region.last.row, extent.first.col,
                       extent.last.col, extent.first.row, extent.last.row));
  }
}

void require_tolerance(Metres tolerance) {
  if (!(tolerance.value >= 0))
    refuse(fmt::format("tolerance {} m: expected a number of metres, 0 or more", tolerance.value));
}

namespace {

void require_neighbour(const StoredPages& pages, GridRect region, const RestrictedQuadtree& neighbour) {
  if (neighbour.origin.identity != pages.identity())
    refuse("a neighbour's answer is from another database, or from another state of it: ask for it again");
  if (neighbour.origin.border != Border::constrain)
    refuse("a neighbour's answer has another border than constrain: ask for it again with a constrained border");
  const GridRect& other = neighbour.region;
  if (!(neighbour.vertices.region() == other)) refuse("a neighbour's vertices cover another region than its own");
  if (!shared_sides(region, other).empty()) return;
  refuse(fmt::format(
      "the neighbour of columns {} to {}, rows {} to {} shares no side with the region of columns {} to {}, "
      "rows {} to {}",
      other.first.col, other.last.col, other.first.row, other.last.row, region.first.col, region.last.col,
      region.first.row, region.last.row));
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
    if (asks_for(question, pair.one, together) && asks_for(question, pair.other, together))
      refuse(std::string(pair.sentence));
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
      fmt::format("increment from {} m to {} m: expected a finer tolerance, Question::tolerance below Question::from",
                  from.value, to.value));
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
  if (question.max_level && *question.max_level < 0)
    refuse(fmt::format("finest level {}: expected 0 or more for Question::max_level", *question.max_level));
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
    refuse(fmt::format(
        "point of interest at column {}, row {}: expected a point in the region, columns {} to {}, rows {} to {}",
        p.col, p.row, question.region.first.col, question.region.last.col, question.region.first.row,
        question.region.last.row));
  }
  for (const RestrictedQuadtree* neighbour : question.neighbours) require_neighbour(pages, question.region, *neighbour);
  return question;
}

}  // namespace talus
