#pragma once
// Rasters of tolerances.

#include <filesystem>

#include "talus/description.hpp"
#include "talus/units.hpp"

namespace talus {

/// Cells in the database's CRS with their tolerances in metres; a cell without a tolerance is void.
struct ToleranceRaster {
  GridMapping cells;
  SampleWindow metres;
};

/// Reads the part of a raster that a region needs. Without position and CRS, its cells divide the region evenly;
/// without CRS, it is in the database's.
///
/// file   a raster as for ingest, with one band
/// fails  as ingest for its inputs; invalid_argument: more bands, another CRS, outside the region
[[nodiscard]] ToleranceRaster read_tolerances(const std::filesystem::path& file, const Description& database,
                                              GridRect region);

}  // namespace talus
