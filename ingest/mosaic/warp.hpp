#pragma once
// Rasters on another grid than their own, by GDAL's warper.

#include <string>

#include "ingest/mosaic/laid_rasters.hpp"

namespace talus {

/// near, bilinear, cubic, average; bilinear where nothing is said.
/// fails  invalid_argument: another word
[[nodiscard]] GDALResampleAlg resampling_of(const std::string& word);

/// Cell sizes and a north-west sample that suit the rasters in that CRS (WKT, without heights).
/// fails  unsupported: GDAL cannot get there
[[nodiscard]] GridMapping suggested_grid(const LaidRasters& laid, const std::string& target_crs);

/// Fills in how the rasters get to the target.
/// fails  unsupported: GDAL cannot get there, or only by guessing a datum; invalid_argument: too many cells, or none
void plan_warp(LaidRasters& laid, const std::string& target_crs, const GridMapping& target, GDALResampleAlg method);

/// The samples of the target that can come from a part of the laid rasters.
/// fails  as plan_warp
[[nodiscard]] GridRect place_of(const LaidRasters& laid, GridRect part);

/// Samples of laid.place, from a dataset of open_laid over all of it. Nothing is read until a window is; blocks are
/// computed one by one and always the same, within 32 MiB. `source` must live on.
struct WarpedBands {
  DatasetOwner heights;  ///< band 1, and band 2, which is not 0 where they are data
  DatasetOwner owners;   ///< band 1: the member whose cell is nearest, counted from 1; null where there is one only
};
[[nodiscard]] WarpedBands warp_dataset(GDALDatasetH source, const LaidRasters& laid);

}  // namespace talus
