#pragma once
// Which band of a raster holds heights, and what colours mean.

#include "ingest/raster/raster_facts.hpp"

namespace talus {

/// Fills `band`, `alphas` and `decode`.
/// fails  unsupported: colours, or colours that were compressed with loss; invalid_argument: no band of heights, or not
/// the one or
///        the colours that were asked for
void take_band(GDALDatasetH dataset, const InputOptions& options, RasterFacts& facts);

/// With a colour code: makes type, scale and offset those of the whole numbers that the colours write.
void take_colour_code(RasterFacts& facts);

}  // namespace talus
