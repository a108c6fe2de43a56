#pragma once
// Rasters laid on one grid.

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
  GridRect extent{{0, 0}, {-1, -1}};  ///< of all rasters
  std::optional<Columns> columns;     ///< which the extent keeps to, where longitudes go all the way round
  std::string crs_wkt;
  std::vector<std::string> notes;
};

/// Fills `place`, and `warp` of those that must be resampled and may be.
///
/// fails  unsupported: grids, CRSs, vertical datums or units that do not go together, with the options that
///        would do; rotation; invalid_argument: options that make no sense, too large an extent
[[nodiscard]] Placement place_on_one_grid(std::vector<RasterFacts>& rasters, const InputOptions& options);

}  // namespace talus
