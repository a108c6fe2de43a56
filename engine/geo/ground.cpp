#include "engine/geo/ground.hpp"

#include <cmath>

namespace talus {

double Ground::full_turn() const {
  if (!crs_.is_geographic) return 0;
  const double turn = 360 / crs_.degrees_per_unit, whole = std::nearbyint(turn);
  return std::abs(turn - whole) < 1e-6 ? whole : turn;  // the unit in radians was rounded
}

double Ground::metres(Position from, Position to) const {
  if (!crs_.is_geographic) return std::hypot(to.x - from.x, to.y - from.y) * crs_.metres_per_unit;
  const double unit = crs_.degrees_per_unit;
  return length_in_degrees({from.x * unit, from.y * unit}, {to.x * unit, to.y * unit}, Metres{crs_.equatorial_radius},
                           crs_.flattening)
      .value;
}

GroundScale Ground::scale_of(const GridMapping& mapping, GridRect extent) const {
  if (!crs_.is_geographic) {
    return GroundScale::planar(Metres{std::abs(mapping.dx) * crs_.metres_per_unit},
                               Metres{std::abs(mapping.dy) * crs_.metres_per_unit});
  }
  GridMapping degrees = mapping;
  for (double* v : {&degrees.x0, &degrees.y0, &degrees.dx, &degrees.dy}) *v *= crs_.degrees_per_unit;
  return GroundScale::geographic(degrees, extent, Metres{crs_.equatorial_radius}, crs_.flattening);
}

}  // namespace talus
