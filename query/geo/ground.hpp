#pragma once
// Lengths on the ground of lines that are straight in CRS coordinates.

#include "engine/geo/geodesy.hpp"
#include "talus/description.hpp"

namespace talus {

class Ground {
 public:
  /// No CRS, or one that is not understood: coordinates are metres.
  explicit Ground(const std::string& crs_wkt);

  /// Coordinates are longitude and latitude.
  [[nodiscard]] bool is_geographic() const { return degrees_per_unit_ != 0; }
  /// Around the globe, in units of the CRS: 360, 400 or so many; 0: not geographic.
  [[nodiscard]] double full_turn() const;
  /// Metres a unit of the CRS, where it is not geographic.
  [[nodiscard]] double metres_per_unit() const { return metres_per_unit_; }

  /// Of the straight line between two positions. In degrees: see length_in_degrees, over the CRS's ellipsoid.
  [[nodiscard]] double metres(Position from, Position to) const;

  /// Of a database's cells, as ingest measures the sides of triangles: the same numbers, bit for bit.
  [[nodiscard]] GroundScale scale_of(const GridMapping& mapping, GridRect extent) const;

 private:
  double metres_per_unit_ = 1;   ///< of a projected CRS
  double degrees_per_unit_ = 0;  ///< of a geographic one; else 0
  Metres radius_;                ///< at the equator
  double flattening_ = 0;
};

}  // namespace talus
