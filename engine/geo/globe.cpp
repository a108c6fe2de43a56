#include "engine/geo/globe.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>

#include "engine/machine/fail.hpp"

namespace talus {

struct Globe::Frames {
  GeographicLib::Geocentric earth;
  std::optional<GeographicLib::LocalCartesian> local = {};
};

Globe::Globe(const CrsFacts& crs)
    : crs_(crs), frames_(new Frames{GeographicLib::Geocentric(crs.equatorial_radius, crs.flattening)}) {}
Globe::Globe(const CrsFacts& crs, Position origin, double height_m) : Globe(crs) {
  const double longitude = origin.x * crs.degrees_per_unit, latitude = origin.y * crs.degrees_per_unit;
  if (!(std::abs(latitude) <= 90)) refuse("origin {}, {}: the latitude must be between the poles", origin.x, origin.y);
  frames_->local.emplace(latitude, longitude, height_m, frames_->earth);
}
Globe::~Globe() = default;

std::array<double, 3> Globe::at(Position position, double height_m) const {
  std::array<double, 3> p{};
  const double longitude = position.x * crs_.degrees_per_unit;
  const double latitude = std::clamp(position.y * crs_.degrees_per_unit, -90.0, 90.0);
  if (frames_->local) {
    frames_->local->Forward(latitude, longitude, height_m, p[0], p[1], p[2]);
  } else {
    frames_->earth.Forward(latitude, longitude, height_m, p[0], p[1], p[2]);
  }
  return p;
}

}  // namespace talus
