#pragma once
// Resamples rasters to another grid with GDAL's warper.

#include <string>

#include "ingest/mosaic/laid_rasters.hpp"

namespace talus {

/// The method for near, bilinear, cubic or average; bilinear if the word is empty.
/// fails  invalid_argument: another word
[[nodiscard]] GDALResampleAlg algorithm_of(Resampling resampling);

/// A grid that suits the rasters in a CRS (WKT, without heights).
/// fails  unsupported: GDAL cannot transform to it
[[nodiscard]] GridMapping suggested_grid(const LaidRasters& laid, const std::string& target_crs);

/// Plans how to resample the rasters to a target.
/// fails  unsupported: GDAL cannot transform to it, or only by guessing a datum; invalid_argument: too many cells, or
///        none
void plan_warp(LaidRasters& laid, const std::string& target_crs, const GridMapping& target, GDALResampleAlg method);

/// The samples of the target that a part of the laid rasters can change.
/// fails  as plan_warp
[[nodiscard]] GridRect place_of(const LaidRasters& laid, GridRect part);

/// Resampled bands over laid.place, from a dataset of open_laid over the whole extent. A block is computed when it is
/// read, always the same way, within 32 MiB. `source` must outlive it.
struct WarpedBands {
  DatasetOwner heights;  ///< band 1: heights; band 2: not 0 where they are valid
  DatasetOwner owners;   ///< band 1: the member with the nearest cell, from 1; null if there is only one
};
[[nodiscard]] WarpedBands warp_dataset(GDALDatasetH source, const LaidRasters& laid);

}  // namespace talus
