#pragma once
// Ground sizes of cells.

#include <vector>

#include "talus/units.hpp"

namespace talus {

/// Of one cell on the ground, in metres.
struct CellSize {
  double width = 1, height = 1;
};

/// How large cells are on the ground, row by row: what a triangle's sides measure in metres.
class GroundScale {
 public:
  /// Cells of one size everywhere, in metres.
  [[nodiscard]] static GroundScale planar(Metres cell_width, Metres cell_height);
  /// Cells in degrees on an ellipsoid (equatorial radius in metres, flattening); beyond a pole counts as the pole.
  [[nodiscard]] static GroundScale geographic(const GridMapping& degrees, GridRect extent, Metres radius,
                                              double flattening);

  /// Of a row; beyond those of the extent that of the nearest.
  [[nodiscard]] CellSize cell(std::int32_t row) const;
  /// At least the longest side of a triangle, with cells as large as they get on its rows.
  [[nodiscard]] Metres longest_side(GridPoint a, GridPoint b, GridPoint c) const;

 private:
  std::int32_t first_row_ = 0;
  std::vector<double> width_m_, height_m_;  // by row; one entry: the same everywhere
  std::int32_t widest_row_ = 0;
};

/// Metres along a line that is straight in degrees, over an ellipsoid of an equatorial radius and flattening; x is the
/// longitude. That is no geodesic. A latitude beyond a pole counts as the pole.
[[nodiscard]] Metres length_in_degrees(Position from, Position to, Metres radius, double flattening);

}  // namespace talus
