#include "query/geo/ground.hpp"

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
  degrees_per_unit_ = crs.GetAngularUnits() * 180 / std::numbers::pi;
  radius_ = Metres{crs.GetSemiMajor()};
  const double inverse = crs.GetInvFlattening();
  flattening_ = inverse == 0 ? 0 : 1 / inverse;
}

double Ground::full_turn() const {
  if (degrees_per_unit_ == 0) return 0;
  const double turn = 360 / degrees_per_unit_, whole = std::nearbyint(turn);
  return std::abs(turn - whole) < 1e-6 ? whole : turn;  // the unit in radians is rounded
}

double Ground::metres(Position from, Position to) const {
  if (degrees_per_unit_ == 0) return std::hypot(to.x - from.x, to.y - from.y) * metres_per_unit_;
  const auto in_degrees = [&](Position p) { return Position{p.x * degrees_per_unit_, p.y * degrees_per_unit_}; };
  return length_in_degrees(in_degrees(from), in_degrees(to), radius_, flattening_).value;
}

GroundScale Ground::scale_of(const GridMapping& mapping, GridRect extent) const {
  if (degrees_per_unit_ == 0)
    return GroundScale::planar(Metres{std::abs(mapping.dx) * metres_per_unit_},
                               Metres{std::abs(mapping.dy) * metres_per_unit_});
  GridMapping degrees = mapping;
  for (double* v : {&degrees.x0, &degrees.y0, &degrees.dx, &degrees.dy}) *v *= degrees_per_unit_;
  return GroundScale::geographic(degrees, extent, radius_, flattening_);
}

}  // namespace talus
