#pragma once
// What one raster file says of itself, and what is made of it.

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gdal.h>
#include <gdalwarper.h>

#include "ingest/file_state.hpp"
#include "ingest/gdal_handles.hpp"
#include "talus/description.hpp"
#include "talus/ingest.hpp"

namespace talus {

inline constexpr double kLargestHeight = 1e6;  ///< metres, up or down

/// How a raster is put on a grid that is not its own.
struct Warp {
  std::string source_crs, target_crs;  ///< WKT, without heights
  GridMapping target;
  GridRect place{{0, 0}, {-1, -1}};  ///< the samples of the target that can come from this raster
  GDALResampleAlg method = GRA_Bilinear;
  GDALDataType type = GDT_Float32;  ///< of the result
};

/// The first band of one file. Everything but `place`, `warp` and `crs_wkt` under --srs is the file's own.
struct RasterFacts {
  std::filesystem::path file;  ///< what is opened: absolute, admitted
  std::string name;            ///< as failures call it: as it was named
  std::string driver;
  std::uint64_t bytes = 0;
  std::vector<FileState> files;  ///< all that it is read from

  GDALDataType type = GDT_Unknown;
  int cols = 0, rows = 0;
  double scale = 1, offset = 0;
  std::uint64_t block_bytes = 0;  ///< of the largest block that GDAL reads as a whole, here or in a file joined by it
  std::optional<double> nodata;  ///< the raw sample that means void, where the type has it; NaN is void anyway
  bool masked = false;           ///< there is a mask beside it
  std::string void_text;         ///< what means void, in words; empty: nothing

  bool is_placed = false, is_rotated = false;
  std::array<double, 6> geotransform{0, 1, 0, 0, 0, -1};
  bool is_mirrored = false, is_south_up = false;  ///< columns run west, rows north: to be turned
  GridMapping mapping;                            ///< of the turned raster; meaningless where it is rotated

  std::string crs_wkt;
  std::string vertical_unit;
  double metres_per_unit = 1;
  std::vector<std::string> notes;  ///< "rows run north and were turned"

  GridRect place{{0, 0}, {-1, -1}};  ///< on the common grid
  std::optional<Warp> warp;

  /// Of the samples that are read: the result's where the raster is resampled.
  [[nodiscard]] GDALDataType read_type() const { return warp ? warp->type : type; }
  [[nodiscard]] bool is_integer() const { return read_type() != GDT_Float32 && read_type() != GDT_Float64; }
};

/// Opens, looks, closes.
///
/// fails  not_found; unsupported: see raster_guard.hpp, sample type, vertical unit; invalid_argument: no band, size
///        or numbers that make no sense; io
[[nodiscard]] RasterFacts look_at(const std::filesystem::path& file, const InputOptions& options);

/// The admitted file, opened again.
[[nodiscard]] DatasetOwner open_dataset(const RasterFacts& facts);

/// fails  unsupported: rotation; invalid_argument: cells so small that doubles cannot tell them apart
void require_own_grid(const RasterFacts& facts);
/// fails  invalid_argument: samples of the extent that doubles cannot tell apart
void require_distinct(const GridMapping& mapping, GridRect extent, const std::string& name);

}  // namespace talus
