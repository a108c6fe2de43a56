#pragma once
// What the CRS says of ground sizes.

#include "engine/geo/geodesy.hpp"
#include "talus/description.hpp"

namespace talus {

/// Projected: the CRS's linear unit. Geographic: metres by latitude on its ellipsoid. None: cells are metres.
[[nodiscard]] GroundScale ground_scale(const Description& description);

}  // namespace talus
