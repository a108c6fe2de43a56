#pragma once
// Converts rectangles in CRS coordinates to regions of the grid.

#include "engine/geo/longitude.hpp"
#include "talus/database.hpp"

namespace talus {

/// See Snapshot::region.
[[nodiscard]] PlacedRectangle placed(const Rectangle& rectangle, const Description& description,
                                     const Longitudes& longitudes);

}  // namespace talus
