#pragma once
// Points on the ellipsoid as coordinates from the centre of the Earth, and from a point on it.

#include <array>
#include <memory>

#include "talus/description.hpp"

namespace talus {

class Globe {
 public:
  /// crs  geographic
  explicit Globe(const CrsFacts& crs);
  ~Globe();
  Globe(const Globe&) = delete;
  Globe& operator=(const Globe&) = delete;

  /// Counts from here from now on: east, north and up. Without it `at` counts from the centre of the Earth.
  /// fails  invalid_argument: a latitude beyond a pole, or a coordinate that is no finite number
  void set_origin(Position position, double height_m);

  /// position  in units of the CRS
  [[nodiscard]] std::array<double, 3> at(Position position, double height_m) const;

 private:
  struct Frames;
  CrsFacts crs_;
  std::unique_ptr<Frames> frames_;
};

}  // namespace talus
