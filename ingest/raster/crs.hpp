#pragma once
// Coordinate reference systems as text, and comparisons of them.

#include <string>

#include <ogr_spatialref.h>

#include "talus/description.hpp"

namespace talus {

/// A user's text (EPSG:25832, WKT, PROJ) as WKT 2.
/// fails  invalid_argument: not a CRS; names `option`
[[nodiscard]] std::string wkt_of(const std::string& user_input, const char* option);
/// fails  unsupported: it has no WKT; names `name`, its owner
[[nodiscard]] std::string wkt_of(const OGRSpatialReference& crs, const std::string& name);

/// fails  unsupported
[[nodiscard]] OGRSpatialReference crs_from(const std::string& wkt);

/// The CRS without its vertical part.
[[nodiscard]] OGRSpatialReference horizontal(const OGRSpatialReference& crs);

/// Whether the CRS defines heights: by a vertical CRS or an ellipsoid.
[[nodiscard]] bool has_heights(const OGRSpatialReference& crs);
/// Whether both define the same heights, or none.
[[nodiscard]] bool same_heights(const OGRSpatialReference& crs, const OGRSpatialReference& other);
/// `target`, with the vertical CRS of `source` if it has none of its own.
[[nodiscard]] std::string with_heights_of(const OGRSpatialReference& target, const OGRSpatialReference& source);

/// The facts of a CRS that Talus needs. If it is empty or cannot be read, its units are metres.
[[nodiscard]] CrsFacts facts_of_crs(const std::string& wkt);

/// A full turn in the units of a geographic CRS, else 0.
[[nodiscard]] double full_turn(const std::string& wkt);

}  // namespace talus
