#pragma once
// What one raster file says of itself, and what is made of it.

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gdal.h>

#include "ingest/files/file_state.hpp"
#include "ingest/files/gdal_handles.hpp"
#include "ingest/files/raster_guard.hpp"
#include "talus/description.hpp"
#include "talus/ingest.hpp"

namespace talus {

inline constexpr double kLargestHeight = 1e6;  ///< metres, up or down

struct LaidRasters;

/// How a raster is put on a grid that is not its own: with all rasters of its own grid, which are laid together first,
/// so that samples beside a joint are interpolated across it.
struct Warp {
  std::shared_ptr<const LaidRasters> laid;
  int member = 0;                    ///< which of those this raster is
  GDALDataType type = GDT_Float32;   ///< of resampled samples
  GridRect place{{0, 0}, {-1, -1}};  ///< the samples of the target that can come from this raster
};

/// The band of one file that holds its heights. Everything but `place`, `warp` and `crs_wkt` under --srs is the file's
/// own.
struct RasterFacts {
  std::filesystem::path file;  ///< what is opened: absolute, admitted
  std::string name;            ///< as failures call it: as it was named
  std::string driver;
  std::string variable;  ///< of a file that holds several rasters
  std::uint64_t bytes = 0;
  std::vector<FileState> files;  ///< all that it is read from

  int band = 1;             ///< that holds the heights; with a colour code the first of three
  std::vector<int> alphas;  ///< bands that say where the raster is transparent: where one is 0, nothing is data
  ColourCode decode = ColourCode::none;
  GDALDataType type = GDT_Unknown;  ///< of the samples that are read, decoded if they are colours
  int cols = 0, rows = 0;
  double scale = 1, offset = 0;
  std::uint64_t block_bytes = 0;  ///< of the largest block that GDAL reads as a whole, here or in a file joined by it
  std::optional<double> nodata;   ///< the raw sample that means void, where the type has it; NaN is void anyway
  std::vector<double> assumed_voids;  ///< raw samples that mean void, said from outside where the file says nothing
  bool masked = false;                ///< there is a mask beside it
  std::string void_text;              ///< what means void, in words; empty: nothing

  bool is_placed = false, is_rotated = false;
  /// How else it states where it lies, in words: "ground control points"; empty: not at all
  std::string other_position;
  std::array<double, 6> geotransform{0, 1, 0, 0, 0, -1};
  bool is_mirrored = false, is_south_up = false;  ///< columns run west, rows north: to be turned
  GridMapping mapping;                            ///< of the turned raster; meaningless where it is rotated

  std::string crs_wkt;
  std::string vertical_unit;
  double metres_per_unit = 1;
  std::vector<std::string> notes;  ///< "rows run north and were turned"

  GridRect place{{0, 0}, {-1, -1}};     ///< on the common grid
  std::vector<std::int32_t> also_east;  ///< where it lies again, so many columns further: the same longitudes
  std::optional<Warp> warp;

  /// Of the samples that are read: the result's where the raster is resampled.
  [[nodiscard]] GDALDataType read_type() const { return warp ? warp->type : type; }
  [[nodiscard]] bool is_integer() const { return read_type() != GDT_Float32 && read_type() != GDT_Float64; }
};

/// The file, admitted and opened by the driver it was admitted for.
/// fails  not_found, unsupported: see raster_guard.hpp; io. The failure names the file
[[nodiscard]] AdmittedRaster open_input(const std::filesystem::path& file, const InputOptions& options);

/// Looks at an open input, and closes it.
///
/// file   its name, for failures
/// fails  not_found; unsupported: see raster_guard.hpp, colours, sample type, vertical unit; invalid_argument: no band,
///        size or numbers that make no sense; io. The failure names the file
[[nodiscard]] RasterFacts look_at(AdmittedRaster input, const std::filesystem::path& file, const InputOptions& options);
[[nodiscard]] RasterFacts look_at(const std::filesystem::path& file, const InputOptions& options);

/// The admitted file, opened again.
[[nodiscard]] DatasetOwner open_dataset(const RasterFacts& facts);

/// fails  unsupported: rotation; invalid_argument: cells so small that doubles cannot tell them apart
void require_own_grid(const RasterFacts& facts);
/// fails  invalid_argument: samples of the extent that doubles cannot tell apart
void require_distinct(const GridMapping& mapping, GridRect extent, const std::string& name);

}  // namespace talus
