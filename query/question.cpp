#include "query/question.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "engine/grid.hpp"
#include "query/ground.hpp"
#include "query/matching.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

[[noreturn]] void refuse(std::string sentence) { throw Failure(Cause::invalid_argument, std::move(sentence)); }

class FocusTolerance final : public ToleranceField {
 public:
  FocusTolerance(double col, double row, double metres_per_col, double metres_per_row, double growth, double at_focus)
      : col_(col), row_(row), right_(metres_per_col), down_(metres_per_row), growth_(growth), at_focus_(at_focus) {}

  [[nodiscard]] double at(GridPoint p) const override { return of(p.col - col_, p.row - row_); }
  /// Of the rectangle's nearest point, on a sample or not.
  [[nodiscard]] double least(GridRect r) const override {
    return of(std::clamp(col_, double(r.first.col), double(r.last.col)) - col_,
              std::clamp(row_, double(r.first.row), double(r.last.row)) - row_);
  }

 private:
  [[nodiscard]] double of(double cols, double rows) const {
    return at_focus_ + growth_ * std::hypot(cols * right_, rows * down_);
  }
  double col_, row_, right_, down_, growth_, at_focus_;
};

class PatchTolerance final : public ToleranceField {
 public:
  PatchTolerance(GridRect region, std::int32_t cols, std::int32_t rows, std::vector<double> metres)
      : region_(region),
        cols_(cols),
        rows_(rows),
        width_((region.cols() + cols - 1) / cols),
        height_((region.rows() + rows - 1) / rows),
        metres_(std::move(metres)) {}

  [[nodiscard]] double at(GridPoint p) const override { return least({p, p}); }
  [[nodiscard]] double least(GridRect r) const override {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    if (r.first.col > region_.last.col || r.last.col < region_.first.col || r.first.row > region_.last.row ||
        r.last.row < region_.first.row)
      return kNone;
    const auto patch = [](std::int64_t v, std::int64_t first, std::int64_t size, std::int64_t count) {
      return std::clamp<std::int64_t>((v - first) / size, 0, count - 1);
    };
    const std::int64_t x0 = patch(std::max(r.first.col, region_.first.col), region_.first.col, width_, cols_);
    const std::int64_t x1 = patch(std::min(r.last.col, region_.last.col), region_.first.col, width_, cols_);
    const std::int64_t y0 = patch(std::max(r.first.row, region_.first.row), region_.first.row, height_, rows_);
    const std::int64_t y1 = patch(std::min(r.last.row, region_.last.row), region_.first.row, height_, rows_);
    double least = kNone;
    for (std::int64_t y = y0; y <= y1; ++y) {
      for (std::int64_t x = x0; x <= x1; ++x) least = std::min(least, metres_[static_cast<std::size_t>(y * cols_ + x)]);
    }
    return least;
  }

 private:
  GridRect region_;
  std::int32_t cols_, rows_;
  std::int64_t width_, height_;
  std::vector<double> metres_;
};

}  // namespace

std::shared_ptr<const ToleranceField> focus_tolerance(const Description& d, double x, double y, double metres_per_metre,
                                                      Metres at_focus) {
  require_tolerance(at_focus);
  if (!std::isfinite(x) || !std::isfinite(y)) refuse(fmt::format("focus {}, {}: expected coordinates", x, y));
  if (!(metres_per_metre >= 0) || !std::isfinite(metres_per_metre))
    refuse(fmt::format("tolerance that grows by {} m a metre: expected 0 or more", metres_per_metre));
  const Ground ground(d.crs_wkt);
  const double right = ground.metres({x, y}, {x + d.mapping.dx, y}),
               down = ground.metres({x, y}, {x, y + d.mapping.dy});
  if (!(right > 0) || !(down > 0))
    refuse(fmt::format("focus {}, {}: cells have no size there; X comes before Y, in the database's CRS", x, y));
  return std::make_shared<FocusTolerance>((x - d.mapping.x0) / d.mapping.dx, (y - d.mapping.y0) / d.mapping.dy, right,
                                          down, metres_per_metre, at_focus.value);
}

std::shared_ptr<const ToleranceField> patch_tolerance(GridRect region, std::int32_t cols, std::int32_t rows,
                                                      std::vector<double> metres) {
  if (cols < 1 || rows < 1 || cols > region.cols() || rows > region.rows()) {
    refuse(fmt::format("{} x {} patches of tolerance: expected from 1 to as many as the region's {} x {} samples", cols,
                       rows, region.cols(), region.rows()));
  }
  if (metres.size() != static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows)) {
    refuse(fmt::format("{} tolerances for {} x {} patches: expected one a patch", metres.size(), cols, rows));
  }
  for (const double m : metres) require_tolerance(Metres{m});
  return std::make_shared<PatchTolerance>(region, cols, rows, std::move(metres));
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
    refuse(fmt::format("region of columns {} to {}, rows {} to {}: expected one within columns {} to {}, rows {} to {}",
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
    refuse("a neighbour is the answer of another database, or of another state of it: ask for it anew");
  if (neighbour.origin.border != Border::constrain)
    refuse("a neighbour's border is not constrained: nothing can meet it in vertices");
  const GridRect& other = neighbour.region;
  if (!(neighbour.vertices.region() == other)) refuse("a neighbour's vertices are not those of its region");
  if (!shared_sides(region, other).empty()) return;
  refuse(fmt::format(
      "the neighbour of columns {} to {}, rows {} to {} shares no side with the region of columns {} to {}, "
      "rows {} to {}",
      other.first.col, other.last.col, other.first.row, other.last.row, region.first.col, region.last.col,
      region.first.row, region.last.row));
}

}  // namespace

void require_sense(const StoredPages& pages, const Question& question) {
  require_inside(pages, question.region);
  require_tolerance(question.tolerance);
  if (question.max_level < 0) refuse(fmt::format("largest level {}: expected 0 or more", question.max_level));
  if (question.border != Border::constrain &&
      (question.field || !question.points.empty() || !question.neighbours.empty()))
    refuse("a tolerance that varies, points of interest and neighbours go with a constrained border only");
  for (const GridPoint p : question.points) {
    if (question.region.contains(p)) continue;
    refuse(fmt::format(
        "point of interest at column {}, row {}: expected one in the region, columns {} to {}, rows {} to {}", p.col,
        p.row, question.region.first.col, question.region.last.col, question.region.first.row,
        question.region.last.row));
  }
  for (const RestrictedQuadtree* neighbour : question.neighbours) require_neighbour(pages, question.region, *neighbour);
}

}  // namespace talus
