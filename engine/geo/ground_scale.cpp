#include "engine/geo/ground_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <GeographicLib/Ellipsoid.hpp>

namespace talus {

GroundScale GroundScale::planar(Metres cell_width, Metres cell_height) {
  GroundScale scale;
  scale.width_m_ = {cell_width.value};
  scale.height_m_ = {cell_height.value};
  return scale;
}

GroundScale GroundScale::geographic(const GridMapping& degrees, GridRect extent, Metres radius, double flattening) {
  const GeographicLib::Ellipsoid ellipsoid(radius.value, flattening);
  constexpr double kPerDegree = std::numbers::pi / 180;
  GroundScale scale;
  scale.first_row_ = extent.first.row;
  for (std::int32_t row = extent.first.row; row <= extent.last.row; ++row) {
    const double latitude = std::clamp(degrees.y(row), -90.0, 90.0);
    scale.width_m_.push_back(ellipsoid.CircleRadius(latitude) * kPerDegree * std::abs(degrees.dx));
    scale.height_m_.push_back(ellipsoid.MeridionalCurvatureRadius(latitude) * kPerDegree * std::abs(degrees.dy));
  }
  scale.widest_row_ =
      extent.first.row + static_cast<std::int32_t>(std::max_element(scale.width_m_.begin(), scale.width_m_.end()) -
                                                   scale.width_m_.begin());
  return scale;
}

CellSize GroundScale::cell(std::int32_t row) const {
  const auto at =
      static_cast<std::size_t>(std::clamp(row - first_row_, 0, static_cast<std::int32_t>(width_m_.size()) - 1));
  return {width_m_[at], height_m_[at]};
}

Metres GroundScale::longest_side(GridPoint a, GridPoint b, GridPoint c) const {
  const auto at = [&](const std::vector<double>& by_row, std::int32_t row) {
    const auto last = static_cast<std::int32_t>(by_row.size()) - 1;
    return by_row[static_cast<std::size_t>(std::clamp(row - first_row_, 0, last))];
  };
  // Cells get narrower and taller away from the equator.
  const auto [top, bottom] = std::minmax({a.row, b.row, c.row});
  const double width = at(width_m_, std::clamp(widest_row_, top, bottom));
  const double height = std::max(at(height_m_, top), at(height_m_, bottom));
  const auto length = [&](GridPoint p, GridPoint q) {
    return std::hypot((p.col - q.col) * width, (p.row - q.row) * height);
  };
  return Metres{std::max({length(a, b), length(a, c), length(b, c)})};
}

Metres length_in_degrees(Position from, Position to, Metres radius, double flattening) {
  const GeographicLib::Ellipsoid ellipsoid(radius.value, flattening);
  // Gauss quadrature with five points on pieces of at most one degree: the error is far below a micrometre.
  constexpr std::array<double, 5> kAt{-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                      0.9061798459386640};
  constexpr std::array<double, 5> kWeight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                          0.4786286704993665, 0.2369268850561891};
  constexpr double kPerDegree = std::numbers::pi / 180;
  const double east = (to.x - from.x) * kPerDegree, north = (to.y - from.y) * kPerDegree;
  const double pieces = std::clamp(std::ceil(std::abs(to.y - from.y)), 1.0, 1000.0);
  double sum = 0;
  for (double piece = 0; piece < pieces; ++piece) {
    for (std::size_t i = 0; i < kAt.size(); ++i) {
      const double t = (piece + (1 + kAt[i]) / 2) / pieces;
      const double latitude = std::clamp(from.y + t * (to.y - from.y), -90.0, 90.0);
      sum += kWeight[i] / 2 *
             std::hypot(ellipsoid.CircleRadius(latitude) * east, ellipsoid.MeridionalCurvatureRadius(latitude) * north);
    }
  }
  return Metres{sum / pieces};
}

}  // namespace talus
