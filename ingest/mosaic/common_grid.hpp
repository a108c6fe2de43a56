#pragma once
// Where rasters lie on one grid, also if their longitudes differ by a full turn.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ingest/raster/raster_facts.hpp"

namespace talus {

inline constexpr double kOnTheGrid = 1e-3;  ///< most cells that a sample may lie off the grid, over the whole raster

/// "a.tif", or "a.tif and 2 more" for three.
[[nodiscard]] std::string name_of_all(const std::string& first, std::size_t count);

/// The place of the raster if its samples lie on the grid's; else empty.
/// fails  invalid_argument: too far away
[[nodiscard]] std::optional<GridRect> place_on(const GridMapping& grid, const RasterFacts& raster);

/// Columns of a full turn, if the CRS (WKT) is geographic and they are a whole number; else 0.
[[nodiscard]] std::int64_t columns_of_a_turn(const std::string& crs_wkt, const GridMapping& grid);

/// Moves places by full turns, so that rasters on both sides of the antimeridian are neighbours. The circle of `turn`
/// columns is cut at its widest gap. Nothing moves unless the places then touch and span less than half a turn. The
/// first place stays.
///
/// returns  the indices of the places that moved
std::vector<std::size_t> join_across_antimeridian(const std::vector<GridRect*>& places, std::int64_t turn);

/// "a.tif and 2 more: moved by a full turn of longitude, to join their neighbours across the antimeridian"
[[nodiscard]] std::string note_of_turn(const std::string& name, std::size_t moved);

}  // namespace talus
