#include "query/pages/placed_rectangle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "talus/question.hpp"

namespace talus {
namespace {

/// A coordinate in cells from grid line 0. It is moved to a grid line if it lies within 10⁻⁶ of a cell of the line, or
/// within the rounding of such large coordinates.
double line_at(double coordinate, double line_0, double cell) {
  constexpr double kOnLine = 1e-6, kApart = 4 * std::numeric_limits<double>::epsilon();
  const double at = (coordinate - line_0) / cell, line = std::round(at);
  const double rounding = kApart * std::max(std::abs(coordinate), std::abs(line_0)) / std::abs(cell);
  return std::abs(at - line) <= std::max(kOnLine, rounding) ? line : at;
}

}  // namespace

PlacedRectangle placed(const Rectangle& asked, const Description& d, const Longitudes& longitudes) {
  const auto text = fmt::format("{},{},{},{}", asked.xmin, asked.ymin, asked.xmax, asked.ymax);
  const Rectangle r = longitudes.among(asked);
  if (!(r.xmin < r.xmax) || !(r.ymin < r.ymax) || !std::isfinite(r.xmin) || !std::isfinite(r.ymin) ||
      !std::isfinite(r.xmax) || !std::isfinite(r.ymax)) {
    const bool is_x = !(r.xmin < r.xmax);
    refuse("rectangle {}: expected four finite numbers with xmin < xmax and ymin < ymax; {} {} is not below {}", text,
           is_x ? "xmin" : "ymin", is_x ? asked.xmin : asked.ymin, is_x ? asked.xmax : asked.ymax);
  }
  const GridMapping& m = d.mapping;
  const double left = line_at(r.xmin, m.x0, m.dx), right = line_at(r.xmax, m.x0, m.dx);
  const double top = line_at(r.ymax, m.y0, m.dy), bottom = line_at(r.ymin, m.y0, m.dy);
  // The rectangle grows outward to grid lines.
  const double west = std::floor(left), east = std::ceil(right), north = std::floor(top), south = std::ceil(bottom);
  const GridRect& e = d.extent;
  const double first_col = std::max<double>(west, e.first.col), last_col = std::min<double>(east, e.last.col);
  const double first_row = std::max<double>(north, e.first.row), last_row = std::min<double>(south, e.last.row);
  const bool thin = e.first.col == e.last.col || e.first.row == e.last.row;  // a raster one sample wide has no area
  if (first_col > last_col || first_row > last_row || (!thin && (first_col == last_col || first_row == last_row))) {
    refuse("rectangle {}: nothing in common with the raster, whose samples span x {} to {}, y {} to {}", text,
           m.x(e.first.col), m.x(e.last.col), m.y(e.last.row), m.y(e.first.row));
  }
  PlacedRectangle found;
  found.samples = {{static_cast<std::int32_t>(first_col), static_cast<std::int32_t>(first_row)},
                   {static_cast<std::int32_t>(last_col), static_cast<std::int32_t>(last_row)}};
  const auto col = [&](double at) { return std::clamp<double>(at, e.first.col, e.last.col); };
  const auto row = [&](double at) { return std::clamp<double>(at, e.first.row, e.last.row); };
  found.frame = {col(left), row(top), col(right), row(bottom)};
  constexpr double kCell = 0.5 + 1e-6;  // samples are the middles of cells
  found.is_cut = left < e.first.col - kCell || right > e.last.col + kCell || top < e.first.row - kCell ||
                 bottom > e.last.row + kCell;
  return found;
}

GridRect snapped(GridRect region, std::int32_t samples, GridRect extent) {
  if (samples < 1) refuse("snap to multiples of {} samples: expected 1 or more", samples);
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

}  // namespace talus
