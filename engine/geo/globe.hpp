#pragma once
// Points on the ellipsoid in metres: from the centre of the Earth (ECEF), or east, north and up from an origin.

#include <array>
#include <memory>

#include "talus/description.hpp"

namespace talus {

class Globe {
 public:
  /// Coordinates from the centre of the Earth. The CRS must be geographic.
  explicit Globe(const CrsFacts& crs);
  /// Coordinates from an origin: east, north, up.
  /// fails  invalid_argument: a latitude beyond a pole
  Globe(const CrsFacts& crs, Position origin, double height_m);
  ~Globe();
  Globe(const Globe&) = delete;
  Globe& operator=(const Globe&) = delete;

  /// position  longitude and latitude in units of the CRS
  [[nodiscard]] std::array<double, 3> at(Position position, double height_m) const;

 private:
  struct Frames;
  CrsFacts crs_;
  std::unique_ptr<Frames> frames_;
};

}  // namespace talus
