#pragma once
// Rectangles in CRS coordinates, on the grid.

#include "engine/geo/longitude.hpp"
#include "talus/database.hpp"

namespace talus {

/// See Snapshot::region.
[[nodiscard]] PlacedRectangle placed(const Rectangle& rectangle, const Description& description,
                                     const Longitudes& longitudes);

}  // namespace talus
