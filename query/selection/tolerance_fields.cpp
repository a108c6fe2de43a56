// Tolerances that vary: with the distance from a point, or from cell to cell of a raster or of patches.

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "engine/geo/ground.hpp"
#include "engine/geo/longitude.hpp"
#include "engine/machine/fail.hpp"
#include "engine/quadtree/rect.hpp"
#include "query/selection/refusals.hpp"
#include "talus/question.hpp"

namespace talus {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// The cells along one axis that hold samples of the region, numbered from 0.
struct Axis {
  std::vector<std::int32_t> of_sample;  ///< the cell of each sample of the region
  std::vector<std::int32_t> cells;      ///< the caller's number of each cell

  void add(std::int32_t cell) {
    if (cells.empty() || cells.back() != cell) cells.push_back(cell);
    of_sample.push_back(static_cast<std::int32_t>(cells.size()) - 1);
  }
};

/// A pyramid over the cells: each number of a level is the least of two by two numbers of the level below.
class CellTolerance final : public ToleranceField {
 public:
  /// metres  tolerance of each cell, row by row
  CellTolerance(GridRect region, Axis cols, Axis rows, std::vector<double> metres)
      : region_(region), cols_(std::move(cols)), rows_(std::move(rows)) {
    levels_.push_back({cols_.cells.size(), rows_.cells.size(), std::move(metres)});
    while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(above(levels_.back()));
  }

  [[nodiscard]] Metres at(GridPoint p) const override { return least({p, p}); }
  /// Exact. The time is in proportion to the outline of the rectangle, in cells.
  [[nodiscard]] Metres least(GridRect r) const override {
    r = common(r, region_);
    if (is_empty(r)) return Metres{kNone};
    const Cells wanted{cell(cols_, r.first.col, region_.first.col), cell(rows_, r.first.row, region_.first.row),
                       cell(cols_, r.last.col, region_.first.col), cell(rows_, r.last.row, region_.first.row)};
    // On this level, two by two numbers span the rectangle.
    const auto level =
        static_cast<std::size_t>(std::bit_width(std::max(wanted.right - wanted.left, wanted.bottom - wanted.top)));
    double least = kNone;
    for (std::size_t y = wanted.top >> level; y <= wanted.bottom >> level; ++y) {
      for (std::size_t x = wanted.left >> level; x <= wanted.right >> level; ++x) take(level, x, y, wanted, least);
    }
    return Metres{least};
  }

 private:
  struct Cells {
    std::size_t left, top, right, bottom;
  };
  struct Level {
    std::size_t width, height;
    std::vector<double> least;
    [[nodiscard]] double at(std::size_t x, std::size_t y) const { return least[y * width + x]; }
  };

  static Level above(const Level& fine) {
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    coarse.least.assign(coarse.width * coarse.height, kNone);
    for (std::size_t y = 0; y < fine.height; ++y) {
      for (std::size_t x = 0; x < fine.width; ++x) {
        double& least = coarse.least[y / 2 * coarse.width + x / 2];
        least = std::min(least, fine.at(x, y));
      }
    }
    return coarse;
  }
  static std::size_t cell(const Axis& axis, std::int32_t sample, std::int32_t first) {
    return static_cast<std::size_t>(axis.of_sample[static_cast<std::size_t>(sample - first)]);
  }

  void take(std::size_t level, std::size_t x, std::size_t y, const Cells& wanted, double& least) const {
    const Level& here = levels_[level];
    if (x >= here.width || y >= here.height || here.at(x, y) >= least) return;
    const std::size_t left = x << level, top = y << level, size = std::size_t{1} << level;
    if (left > wanted.right || left + size <= wanted.left || top > wanted.bottom || top + size <= wanted.top) return;
    if (left >= wanted.left && left + size - 1 <= wanted.right && top >= wanted.top &&
        top + size - 1 <= wanted.bottom) {
      least = here.at(x, y);
      return;
    }
    for (const std::size_t i : {0u, 1u, 2u, 3u}) take(level - 1, 2 * x + i % 2, 2 * y + i / 2, wanted, least);
  }

  GridRect region_;
  Axis cols_, rows_;
  std::vector<Level> levels_;
};

/// The cells along one axis that hold the samples of a region.
///
/// x0, dx   coordinate of sample 0, and step to the next; c0, dc: the same for cells
/// returns  no cells if a sample lies outside all of them
Axis cells_of(double x0, double dx, std::int32_t first, std::int32_t last, double c0, double dc,
              std::int32_t first_cell, std::int32_t last_cell) {
  constexpr double kOnLine = 1e-6;
  const double sample = std::abs(dx / dc);  // in cells
  Axis axis;
  if (last_cell < first_cell) return axis;
  for (std::int32_t v = first; v <= last; ++v) {
    const double at = (x0 + v * dx - c0) / dc + 0.5;  // in cells from the edge of cell 0
    if (!(at >= first_cell - sample - kOnLine && at <= last_cell + 1.0 + sample + kOnLine)) return {};
    axis.add(static_cast<std::int32_t>(std::clamp<double>(std::floor(at + kOnLine), first_cell, last_cell)));
  }
  return axis;
}

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
  if (!std::isfinite(x) || !std::isfinite(y)) refuse("focus {}, {}: expected two finite numbers", x, y);
  if (!(metres_per_metre >= 0) || !std::isfinite(metres_per_metre))
    refuse("tolerance that grows by {} m a metre: expected 0 or more", metres_per_metre);
  const double col = (x - d.mapping.x0) / d.mapping.dx, row = (y - d.mapping.y0) / d.mapping.dy;
  const GridRect& e = d.extent;
  if (!(col >= e.first.col - 0.5 && col <= e.last.col + 0.5 && row >= e.first.row - 0.5 && row <= e.last.row + 0.5)) {
    refuse(
        "focus {}, {} lies outside the raster, whose samples span {},{},{},{}; X comes before Y, in the database's CRS",
        x, y, d.mapping.x(e.first.col), d.mapping.y(e.last.row), d.mapping.x(e.last.col), d.mapping.y(e.first.row));
  }
  const Ground ground(d.crs);
  const double right = ground.metres({x, y}, {x + d.mapping.dx, y}),
               down = ground.metres({x, y}, {x, y + d.mapping.dy});
  if (!(right > 0) || !(down > 0))
    refuse("focus {}, {}: cells have no size there; X comes before Y, in the database's CRS", x, y);
  return std::make_shared<FocusTolerance>(col, row, right, down, metres_per_metre, at_focus.value);
}

std::shared_ptr<const ToleranceField> patch_tolerance(GridRect region, std::int32_t cols, std::int32_t rows,
                                                      std::vector<double> metres) {
  if (cols < 1 || rows < 1 || cols > region.cols() || rows > region.rows()) {
    refuse("{} x {} patches of tolerance: expected at least 1 x 1, at most the region's {} x {} samples", cols, rows,
           region.cols(), region.rows());
  }
  if (metres.size() != static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows))
    refuse("{} tolerances for {} x {} patches: expected one for each patch", metres.size(), cols, rows);
  if (metres.size() != static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows))
    refuse("{} tolerances for {} x {} patches: expected one a patch", metres.size(), cols, rows);
  for (const double m : metres) require_tolerance(Metres{m});
  const auto evenly = [](std::int64_t samples, std::int64_t patches) {
    Axis axis;
    for (std::int64_t i = 0; i < samples; ++i) axis.add(static_cast<std::int32_t>(i * patches / samples));
    return axis;
  };
  return std::make_shared<CellTolerance>(region, evenly(region.cols(), cols), evenly(region.rows(), rows),
                                         std::move(metres));
}

std::shared_ptr<const ToleranceField> raster_tolerance(const Description& d, GridRect region, const GridMapping& cells,
                                                       const SampleWindow& metres) {
  const GridMapping& m = d.mapping;
  const GridRect& there = metres.region;
  Axis cols =
      cells_of(m.x0, m.dx, region.first.col, region.last.col, cells.x0, cells.dx, there.first.col, there.last.col);
  Axis rows =
      cells_of(m.y0, m.dy, region.first.row, region.last.row, cells.y0, cells.dy, there.first.row, there.last.row);
  if (cols.cells.empty() || rows.cells.empty()) {
    refuse("the tolerances do not cover the whole region, x {} to {}, y {} to {}", m.x(region.first.col),
           m.x(region.last.col), m.y(region.last.row), m.y(region.first.row));
  }
  std::vector<double> used;
  used.reserve(cols.cells.size() * rows.cells.size());
  for (const std::int32_t row : rows.cells) {
    for (const std::int32_t col : cols.cells) {
      const GridPoint cell{col, row};
      const std::size_t i = metres.index(cell);
      if (metres.valid[i] == 0 || !(metres.values[i] >= 0)) {
        refuse("tolerance of the cell at {}, {} (column {}, row {}) is {}: expected metres, 0 or more",
               cells.x(cell.col), cells.y(cell.row), cell.col, cell.row,
               metres.valid[i] == 0 ? "void" : fmt::format("{}", metres.values[i]));
      }
      used.push_back(metres.values[i]);
    }
  }
  return std::make_shared<CellTolerance>(region, std::move(cols), std::move(rows), std::move(used));
}

}  // namespace talus
