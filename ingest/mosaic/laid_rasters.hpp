#pragma once
// Rasters of one grid laid together, as GDAL sees a dataset: what is resampled.

#include <array>
#include <string>
#include <vector>

#include <gdalwarper.h>

#include "ingest/raster/raster_facts.hpp"

namespace talus {

/// Rasters whose samples fall on each other, and how they get to another grid.
struct LaidRasters {
  std::vector<RasterFacts> members;  ///< `place` on their own grid; the last is on top
  GridMapping mapping;               ///< of that grid; meaningless for one raster that is rotated
  GridRect extent{{0, 0}, {-1, -1}};
  std::array<double, 6> geotransform{};  ///< of the extent
  std::string crs_wkt;
  GDALDataType type =
      GDT_Unknown;  ///< of the laid samples: the members' own where all have one, with one scale and offset
  double scale = 1, offset = 0;

  // Filled by plan_warp:
  std::string source_crs, target_crs;  ///< WKT, without heights
  GridMapping target;
  GridRect place{{0, 0}, {-1, -1}};  ///< the samples of the target that can come from here
  double x_scale = 1, y_scale = 1;   ///< cells of the target a cell
  GDALResampleAlg method = GRA_Bilinear;
  GDALDataType type_of_result = GDT_Float32;
};

/// One set a grid of rasters that are placed, in the CRS (WKT), or all by themselves; each raster is in one of them.
/// notes  a sentence where rasters were moved by a full turn of longitudes to join others
[[nodiscard]] std::vector<LaidRasters> laid_together(const std::vector<RasterFacts>& rasters,
                                                     std::vector<std::string>& notes);

/// Band 1 holds the laid samples of `part` and has a mask, band 2 which member each is from, counted from 1, 0 where
/// none lies. Nothing is opened until a sample is read. What fails then is kept for rethrow_failure, for no exception
/// may pass GDAL.
[[nodiscard]] DatasetOwner open_laid(const LaidRasters& laid, GridRect part);
/// What the reading of a dataset of open_laid failed with since the last call, if anything.
void rethrow_failure(GDALDatasetH dataset);

}  // namespace talus
