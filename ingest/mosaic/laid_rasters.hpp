#pragma once
// Rasters of one grid, laid together as a GDAL dataset, in order to be resampled.

#include <array>
#include <string>
#include <vector>

#include <gdalwarper.h>

#include "ingest/raster/raster_facts.hpp"

namespace talus {

/// Rasters on one grid, and how they are resampled to another.
struct LaidRasters {
  std::vector<RasterFacts> members;  ///< placed on their own grid; the last is on top
  GridMapping mapping;               ///< grid of the members; meaningless for a single rotated raster
  GridRect extent{{0, 0}, {-1, -1}};
  std::array<double, 6> geotransform{};  ///< geotransform of the extent
  std::string crs_wkt;
  GDALDataType type =
      GDT_Unknown;  ///< type of the laid samples: the members' own if all have the same type, scale and offset
  double scale = 1, offset = 0;

  // Set by plan_warp:
  std::string source_crs, target_crs;  ///< WKT, without heights
  GridMapping target;
  GridRect place{{0, 0}, {-1, -1}};  ///< the samples of the target that these rasters can change
  double x_scale = 1, y_scale = 1;   ///< cells of the target per cell
  GDALResampleAlg method = GRA_Bilinear;
  GDALDataType type_of_result = GDT_Float32;
};

/// One set for each grid of placed rasters in the CRS (WKT); the other rasters are alone. Each raster is in one set.
/// notes  receives a sentence if rasters were moved by a full turn of longitude
[[nodiscard]] std::vector<LaidRasters> laid_together(const std::vector<RasterFacts>& rasters,
                                                     std::vector<std::string>& notes);

/// A dataset over `part`. Band 1 has the laid samples and a mask. Band 2 has the number of the member that each is
/// from, from 1; 0: none. Files are opened when a sample is read. A failure then is kept for rethrow_failure, because
/// exceptions must not pass through GDAL.
[[nodiscard]] DatasetOwner open_laid(const LaidRasters& laid, GridRect part);
/// Throws the failure, if any, of reading a dataset of open_laid since the last call.
void rethrow_failure(GDALDatasetH dataset);

}  // namespace talus
