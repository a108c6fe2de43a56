#include "engine/geo/longitude.hpp"

#include <algorithm>
#include <cmath>

#include "engine/geo/ground.hpp"
#include "engine/machine/fail.hpp"

namespace talus {
namespace {

constexpr double kOnLine = 1e-6;  // of a cell: closer than this counts as on the line
constexpr double kFarOut = 1e6;   // turns: a double cannot hold degrees that far out

}  // namespace

Longitudes::Longitudes(double turn, const Description& d) : turn_(turn), mapping_(d.mapping), extent_(d.extent) {}
Longitudes::Longitudes(const Description& d) : Longitudes(Ground(d.crs).full_turn(), d) {}

Position Longitudes::among(Position p, GridRect rect) const {
  if (turn_ == 0 || !std::isfinite(p.x)) return p;
  for (const double margin : {kOnLine, 0.5}) {
    const double west = x(rect.first.col - margin), east = x(rect.last.col + margin);
    if (p.x >= west && p.x <= east) return p;
    // The easternmost equivalent longitude that is not east of the rectangle. If one lies inside, it is this one.
    const double moved = p.x - std::ceil((p.x - east) / turn_) * turn_;
    if (moved >= west && moved <= east) return {moved, p.y};
  }
  return p;
}

std::vector<Position> Longitudes::short_way(std::span<const Position> line) const {
  std::vector<Position> way(line.begin(), line.end());
  if (turn_ == 0) return way;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const double turns = (way[i - 1].x - way[i].x) / turn_;
    // Half a turn is equally far both ways: keep it as it is.
    if (std::abs(turns) > 0.5 && std::isfinite(turns)) way[i].x += std::ceil(turns - 0.5) * turn_;
  }
  return way;
}

std::vector<double> Longitudes::shifts(double from, double to, GridRect rect) const {
  std::vector<double> found;
  if (turn_ != 0 && std::abs(from) < kFarOut * turn_ && std::abs(to) < kFarOut * turn_) {
    const double west = x(rect.first.col), east = x(rect.last.col);
    const auto [low, high] = std::minmax(from, to);
    for (double turns = std::ceil((west - high) / turn_); low + turns * turn_ <= east; ++turns)
      found.push_back(turns * turn_);
  }
  if (found.empty()) found.push_back(0);
  return found;
}

Rectangle Longitudes::among(const Rectangle& asked) const {
  if (turn_ == 0 || !std::isfinite(asked.xmin) || !std::isfinite(asked.xmax)) return asked;
  Rectangle box = asked;
  if (box.xmin > box.xmax && box.xmax + turn_ > box.xmin && box.xmax + turn_ - box.xmin <= turn_ / 2) box.xmax += turn_;
  if (!(box.xmin < box.xmax)) return asked;
  const double west = x(extent_.first.col), east = x(extent_.last.col);
  if (box.xmax - box.xmin >= turn_)  // all longitudes
    return {west - mapping_.dx / 2, box.ymin, east + mapping_.dx / 2, box.ymax};
  // The equivalents of the box that share a cell or more with the raster.
  struct Part {
    double shift, west, east;
  };
  std::vector<Part> parts;
  for (double turns = std::ceil((west - box.xmax) / turn_); box.xmin + turns * turn_ <= east; ++turns) {
    const Part part{turns * turn_, std::max(west, box.xmin + turns * turn_), std::min(east, box.xmax + turns * turn_)};
    if (part.east - part.west >= mapping_.dx || parts.empty()) parts.push_back(part);
  }
  if (parts.empty()) return asked;
  const Part& widest = *std::max_element(
      parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.east - a.west < b.east - b.west; });
  const bool is_all = widest.west == west && widest.east == east;
  const auto has_area = [&](const Part& p) { return p.east - p.west >= mapping_.dx; };
  if (!is_all && std::count_if(parts.begin(), parts.end(), has_area) > 1) {
    const Part &first = parts.front(), &second = parts.back();
    refuse("rectangle {},{},{},{} meets both ends of the raster: ask for {},{},{},{} and for {},{},{},{}", asked.xmin,
           asked.ymin, asked.xmax, asked.ymax, first.west, asked.ymin, first.east, asked.ymax, second.west, asked.ymin,
           second.east, asked.ymax);
  }
  return {box.xmin + widest.shift, box.ymin, box.xmax + widest.shift, box.ymax};
}

}  // namespace talus
