#pragma once
// Where rasters lie on one grid, also where their longitudes are written a full turn away from each other.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ingest/raster/raster_facts.hpp"

namespace talus {

inline constexpr double kOnTheGrid = 1e-3;  ///< cells between a sample and the grid's, over the whole raster

/// Where the raster lies if its samples are the grid's own.
/// fails  invalid_argument: too far away
[[nodiscard]] std::optional<GridRect> place_on(const GridMapping& grid, const RasterFacts& raster);

/// Columns of a full turn in a CRS (WKT) that counts longitudes, if they are a whole number; else 0.
[[nodiscard]] std::int64_t columns_of_a_turn(const std::string& crs_wkt, const GridMapping& grid);

/// Rasters on both sides of the antimeridian are neighbours: laid on a circle of `turn` columns that is cut at its
/// widest gap, if they then touch and span less than half a turn. The first place stays where it is. returns  which
/// places were moved, by whole turns
std::vector<std::size_t> join_across_antimeridian(const std::vector<GridRect*>& places, std::int64_t turn);

/// "a.tif and 2 more: placed a full turn further, to join its neighbours across the antimeridian"
[[nodiscard]] std::string note_of_turn(const std::string& name, std::size_t moved);

}  // namespace talus
