#pragma once
// Finds the bands that hold heights, or colours that encode heights.

#include "ingest/raster/raster_facts.hpp"

namespace talus {

/// Sets `band`, `alphas` and `decode`.
/// fails  unsupported: colours, or colours that were compressed with loss; invalid_argument: no band of heights, not
///        the band or the colours that were asked for
void take_band(GDALDatasetH dataset, const InputOptions& options, RasterFacts& facts);

/// If colours encode heights: sets type, scale and offset to those of the encoded numbers.
void take_colour_code(RasterFacts& facts);

}  // namespace talus
