#pragma once
// Points on the ellipsoid as coordinates from the centre of the Earth, and from a point on it.

#include <array>
#include <memory>

#include "talus/description.hpp"

namespace talus {

class Globe {
 public:
  /// Counts from the centre of the Earth.
  /// crs  geographic
  explicit Globe(const CrsFacts& crs);
  /// Counts from a point: east, north and up.
  /// fails  invalid_argument: a latitude beyond a pole
  Globe(const CrsFacts& crs, Position origin, double height_m);
  ~Globe();
  Globe(const Globe&) = delete;
  Globe& operator=(const Globe&) = delete;

  /// position  in units of the CRS
  [[nodiscard]] std::array<double, 3> at(Position position, double height_m) const;

 private:
  struct Frames;
  CrsFacts crs_;
  std::unique_ptr<Frames> frames_;
};

}  // namespace talus
