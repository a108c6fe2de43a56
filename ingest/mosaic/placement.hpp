#pragma once
// Puts rasters on one grid.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ingest/raster/raster_facts.hpp"

namespace talus {

struct Columns {
  std::int32_t first, last;
};

struct Placement {
  GridMapping mapping;
  GridRect extent{{0, 0}, {-1, -1}};  ///< rectangle of all rasters
  std::optional<Columns> columns;     ///< the grid's columns, if longitudes go around the globe
  std::string crs_wkt;
  std::vector<std::string> notes;
};

/// Sets `place`, and `warp` of the rasters that are resampled.
///
/// fails  unsupported: grids, CRSs, vertical datums or units that do not fit, or rotation; names options that help
///        invalid_argument: impossible options, too large an extent
[[nodiscard]] Placement place_on_one_grid(std::vector<RasterFacts>& rasters, const InputOptions& options);

}  // namespace talus
