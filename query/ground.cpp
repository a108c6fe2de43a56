#include "query/ground.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <ogr_spatialref.h>

namespace talus {

Ground::Ground(const std::string& crs_wkt) {
  OGRSpatialReference crs;
  if (crs_wkt.empty() || crs.importFromWkt(crs_wkt.c_str()) != OGRERR_NONE) return;
  if (crs.IsGeographic() == 0) {
    metres_per_unit_ = crs.GetLinearUnits();
    return;
  }
  radians_per_unit_ = crs.GetAngularUnits();
  equatorial_radius_ = crs.GetSemiMajor();
  const double inverse = crs.GetInvFlattening(), flattening = inverse == 0 ? 0 : 1 / inverse;
  eccentricity2_ = flattening * (2 - flattening);
}

double Ground::metres(Position from, Position to) const {
  if (radians_per_unit_ == 0) return std::hypot(to.x - from.x, to.y - from.y) * metres_per_unit_;
  // Gauss' rule with five points over pieces of at most a degree is exact to far below a micrometre.
  constexpr std::array<double, 5> kAt{-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                      0.9061798459386640};
  constexpr std::array<double, 5> kWeight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                          0.4786286704993665, 0.2369268850561891};
  constexpr double kPole = std::numbers::pi / 2, kDegree = std::numbers::pi / 180;
  const double east = (to.x - from.x) * radians_per_unit_, north = (to.y - from.y) * radians_per_unit_;
  const double pieces = std::clamp(std::ceil(std::abs(north) / kDegree), 1.0, 1000.0);
  double sum = 0;
  for (double piece = 0; piece < pieces; ++piece) {
    for (std::size_t i = 0; i < kAt.size(); ++i) {
      const double t = (piece + (1 + kAt[i]) / 2) / pieces;
      const double latitude = std::clamp(from.y * radians_per_unit_ + t * north, -kPole, kPole);
      const double sine = std::sin(latitude), w2 = 1 - eccentricity2_ * sine * sine;
      const double prime_vertical = equatorial_radius_ / std::sqrt(w2);
      const double meridional = prime_vertical * (1 - eccentricity2_) / w2;
      sum += kWeight[i] / 2 * std::hypot(prime_vertical * std::cos(latitude) * east, meridional * north);
    }
  }
  return sum / pieces;
}

}  // namespace talus
