#pragma once
// Rasters whose cells are tolerances, not heights.

#include <filesystem>

#include "talus/description.hpp"
#include "talus/units.hpp"

namespace talus {

/// Where its cells are in a database's CRS, and their metres; a cell without is void.
struct ToleranceRaster {
  GridMapping cells;
  SampleWindow metres;
};

/// The part of a raster that a region needs. One that says neither where it is nor in which CRS lies evenly over the
/// region; one that says no CRS is taken to be in the database's.
///
/// file   as ingest takes them, of one band
/// fails  as ingest does for its inputs; invalid_argument: more bands, another CRS, nothing in common with the region
[[nodiscard]] ToleranceRaster read_tolerances(const std::filesystem::path& file, const Description& database,
                                              GridRect region);

}  // namespace talus
