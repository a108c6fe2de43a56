#pragma once
// Rasters on another grid than their own, by GDAL's warper.

#include <optional>
#include <string>

#include "ingest/raster_facts.hpp"

namespace talus {

/// near, bilinear, cubic, average; bilinear where nothing is said.
/// fails  invalid_argument: another word
[[nodiscard]] GDALResampleAlg resampling_of(const std::string& word);

/// Cell sizes and a north-west sample that suit the raster in that CRS (WKT, without heights).
/// fails  unsupported: GDAL cannot get there
[[nodiscard]] GridMapping suggested_grid(const RasterFacts& facts, const std::string& target_crs);

/// What resamples this raster to the target.
/// fails  unsupported: GDAL cannot get there, or only by guessing a datum; invalid_argument: too many cells, or none
[[nodiscard]] Warp plan_warp(const RasterFacts& facts, const std::string& target_crs, const GridMapping& target,
                             GDALResampleAlg method);

/// Band 1 holds samples of facts.warp->place, band 2 is not 0 where they are data. Nothing is read until a
/// window is; blocks are computed one by one and always the same, within 32 MiB.
/// source  the open raster, which must live on
[[nodiscard]] DatasetOwner warp_dataset(GDALDatasetH source, const RasterFacts& facts);

}  // namespace talus
