#pragma once
// Coordinate systems as text, and what must be known of two of them.

#include <string>

#include <ogr_spatialref.h>

#include "talus/description.hpp"

namespace talus {

/// What a user wrote (EPSG:25832, WKT, PROJ) as WKT 2.
/// fails  invalid_argument: nothing of the kind, named with `option`
[[nodiscard]] std::string wkt_of(const std::string& user_input, const char* option);
/// fails  unsupported: it has no WKT; `name` says whose it is
[[nodiscard]] std::string wkt_of(const OGRSpatialReference& crs, const std::string& name);

/// fails  unsupported
[[nodiscard]] OGRSpatialReference crs_from(const std::string& wkt);

/// Without its heights.
[[nodiscard]] OGRSpatialReference horizontal(const OGRSpatialReference& crs);

/// What heights count from, if the CRS says so: a vertical CRS or an ellipsoid.
[[nodiscard]] bool has_heights(const OGRSpatialReference& crs);
/// Both say nothing, or the same.
[[nodiscard]] bool same_heights(const OGRSpatialReference& crs, const OGRSpatialReference& other);
/// `target`, with the vertical CRS of `source` where it has none itself.
[[nodiscard]] std::string with_heights_of(const OGRSpatialReference& target, const OGRSpatialReference& source);

/// What Talus needs to know of a CRS. No CRS, or one that is not understood: coordinates are metres.
[[nodiscard]] CrsFacts facts_of_crs(const std::string& wkt);

/// A full turn in the CRS's units if it counts longitudes, else 0.
[[nodiscard]] double full_turn(const std::string& wkt);

}  // namespace talus
