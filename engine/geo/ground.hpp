#pragma once
// Lengths on the ground, from the units and the ellipsoid of a CRS.

#include "engine/geo/ground_scale.hpp"
#include "talus/description.hpp"

namespace talus {

class Ground {
 public:
  explicit Ground(const CrsFacts& crs) : crs_(crs) {}

  /// Coordinates are longitude and latitude.
  [[nodiscard]] bool is_geographic() const { return crs_.is_geographic; }
  /// One turn around the globe in units of the CRS: 360 for degrees, 400 for gon. 0: not geographic.
  [[nodiscard]] double full_turn() const;
  /// Metres in a unit of a CRS that is not geographic.
  [[nodiscard]] double metres_per_unit() const { return crs_.metres_per_unit; }

  /// The length of the straight line between two positions; geographic: see length_in_degrees.
  [[nodiscard]] double metres(Position from, Position to) const;

  /// The cell sizes of a raster. Ingest and verify get the same numbers, bit for bit.
  [[nodiscard]] GroundScale scale_of(const GridMapping& mapping, GridRect extent) const;

 private:
  CrsFacts crs_;
};

}  // namespace talus
