// Points and lines in CRS coordinates become samples that an answer must hold.

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "talus/failure.hpp"
#include "talus/quadtree.hpp"

namespace talus {
namespace {

[[noreturn]] void refuse(const std::string& sentence) { throw Failure(Cause::invalid_argument, sentence); }

class Nearest {
 public:
  Nearest(const Description& description, GridRect region) : mapping_(description.mapping), region_(region) {}

  [[nodiscard]] Place place(Position p) const {
    if (!std::isfinite(p.x) || !std::isfinite(p.y))
      refuse(fmt::format("point {}, {}: expected coordinates, two finite numbers", p.x, p.y));
    const Place place{(p.x - mapping_.x0) / mapping_.dx, (p.y - mapping_.y0) / mapping_.dy};
    const double col = nearest(place.col), row = nearest(place.row);
    if (!(col >= region_.first.col && col <= region_.last.col && row >= region_.first.row && row <= region_.last.row)) {
      refuse(fmt::format("point {}, {}: expected one in the region, x {} to {}, y {} to {}", p.x, p.y,
                         mapping_.x(region_.first.col), mapping_.x(region_.last.col), mapping_.y(region_.last.row),
                         mapping_.y(region_.first.row)));
    }
    return place;
  }
  [[nodiscard]] static GridPoint sample(Place p) {
    return {static_cast<std::int32_t>(nearest(p.col)), static_cast<std::int32_t>(nearest(p.row))};
  }

 private:
  // Amid two samples, or within rounding of that, the next one: a diagonal amid samples would else jump to and fro.
  static double nearest(double v) { return std::floor(v + (0.5 + 1e-6)); }
  GridMapping mapping_;
  GridRect region_;
};

void add(GridPoint p, std::vector<GridPoint>& samples) {
  if (samples.empty() || samples.back() != p) samples.push_back(p);
}

/// All that lies on a column (or row, if that axis is the longer) between the ends.
void add_part(Place from, Place to, std::vector<GridPoint>& samples) {
  const double cols = to.col - from.col, rows = to.row - from.row;
  const bool along_cols = std::abs(cols) >= std::abs(rows);
  const double begin = along_cols ? from.col : from.row, length = along_cols ? cols : rows;
  const double direction = length < 0 ? -1 : 1;
  add(Nearest::sample(from), samples);
  for (double at = std::ceil(begin * direction); at <= (begin + length) * direction; ++at) {
    if (length == 0) break;
    const double on_axis = at * direction, t = (on_axis - begin) / length;
    add(Nearest::sample(along_cols ? Place{on_axis, from.row + t * rows} : Place{from.col + t * cols, on_axis}),
        samples);
  }
  add(Nearest::sample(to), samples);
}

}  // namespace

std::vector<GridPoint> samples_nearest(const Description& description, GridRect region,
                                       std::span<const Position> points) {
  const Nearest nearest(description, region);
  std::vector<GridPoint> samples;
  samples.reserve(points.size());
  for (const Position p : points) samples.push_back(Nearest::sample(nearest.place(p)));
  return samples;
}

std::vector<GridPoint> samples_along(const Description& description, GridRect region, std::span<const Position> line) {
  if (line.size() < 2) refuse(fmt::format("line of {} points: expected two or more", line.size()));
  const Nearest nearest(description, region);
  std::vector<GridPoint> samples;
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    add_part(nearest.place(line[i]), nearest.place(line[i + 1]), samples);
  return samples;
}

}  // namespace talus
