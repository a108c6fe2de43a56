#pragma once
// Sizes of cells and lengths of lines on the ground.

#include <vector>

#include "talus/units.hpp"

namespace talus {

/// The size of one cell on the ground, in metres.
struct CellSize {
  double width = 1, height = 1;
};

/// The sizes of cells on the ground, row by row.
class GroundScale {
 public:
  /// All cells have the same size.
  [[nodiscard]] static GroundScale planar(Metres cell_width, Metres cell_height);
  /// Cells in degrees on an ellipsoid (equatorial radius, flattening); a latitude beyond a pole counts as the pole.
  [[nodiscard]] static GroundScale geographic(const GridMapping& degrees, GridRect extent, Metres radius,
                                              double flattening);

  /// The cell size of a row; outside the extent that of the nearest row.
  [[nodiscard]] CellSize cell(std::int32_t row) const;
  /// An upper bound of the longest side of a triangle: it uses the largest cells on the triangle's rows.
  [[nodiscard]] Metres longest_side(GridPoint a, GridPoint b, GridPoint c) const;

 private:
  std::int32_t first_row_ = 0;
  std::vector<double> width_m_, height_m_;  // by row; one entry: the same for all rows
  std::int32_t widest_row_ = 0;
};

/// Metres along a line that is straight in degrees, on an ellipsoid; x is the longitude. The line is not a geodesic. A
/// latitude beyond a pole counts as the pole.
[[nodiscard]] Metres length_in_degrees(Position from, Position to, Metres radius, double flattening);

}  // namespace talus
