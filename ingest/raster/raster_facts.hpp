#pragma once
// The facts of a raster file, and how Talus reads it.

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

/// How a raster is resampled to another grid. All rasters of its own grid are laid together first, so that heights
/// beside a joint are interpolated across it.
struct Warp {
  std::shared_ptr<const LaidRasters> laid;
  int member = 0;                    ///< the number of this raster among them
  GDALDataType type = GDT_Float32;   ///< type of the resampled samples
  GridRect place{{0, 0}, {-1, -1}};  ///< the samples of the target that this raster can change
};

/// The band of a file that holds its heights. All but `place`, `warp` and a replaced `crs_wkt` comes from the file.
struct RasterFacts {
  std::filesystem::path file;  ///< absolute and admitted
  std::string name;            ///< as the user named it, for failures
  std::string driver;
  std::string variable;  ///< the raster in a file with several
  std::uint64_t bytes = 0;
  std::vector<FileState> files;  ///< all files that it is read from

  int band = 1;             ///< the band of heights; of encoded colours, the first of three
  std::vector<int> alphas;  ///< bands that are 0 where the raster is void
  ColourCode decode = ColourCode::none;
  GDALDataType type = GDT_Unknown;  ///< type of samples as read; if they are colours, as decoded
  int cols = 0, rows = 0;
  double scale = 1, offset = 0;
  std::uint64_t block_bytes = 0;      ///< size of the largest block that GDAL reads as a whole, here or in a source
  std::optional<double> nodata;       ///< the raw sample that means void, if the type has it; NaN is always void
  std::vector<double> assumed_voids;  ///< raw samples that mean void because the user said so
  bool masked = false;                ///< has a mask
  std::string void_text;              ///< all that means void, in words; empty: nothing

  bool is_placed = false, is_rotated = false;
  /// Another statement of its position, in words: "ground control points"; empty: none
  std::string other_position;
  std::array<double, 6> geotransform{0, 1, 0, 0, 0, -1};
  bool is_mirrored = false, is_south_up = false;  ///< columns run west, rows run north
  GridMapping mapping;                            ///< after reversing; meaningless if it is rotated

  std::string crs_wkt;
  std::string vertical_unit;
  double metres_per_unit = 1;
  std::vector<std::string> notes;  ///< "rows run north; Talus reversed them"

  GridRect place{{0, 0}, {-1, -1}};     ///< on the common grid
  std::vector<std::int32_t> also_east;  ///< further places, so many columns east: the same longitudes
  std::optional<Warp> warp;

  /// The type of samples as read; if resampled, of the result.
  [[nodiscard]] GDALDataType read_type() const { return warp ? warp->type : type; }
  [[nodiscard]] bool is_integer() const { return read_type() != GDT_Float32 && read_type() != GDT_Float64; }
};

/// Admits the file and opens it by its driver.
/// fails  not_found, unsupported: see raster_guard.hpp; io; names the file
[[nodiscard]] AdmittedRaster open_input(const std::filesystem::path& file, const InputOptions& options);

/// Reads the facts of an open input, and closes it.
///
/// file   its name, for failures
/// fails  not_found; unsupported: see raster_guard.hpp, colours, sample type, vertical unit; invalid_argument: no band,
///        impossible size or numbers; io; names the file
[[nodiscard]] RasterFacts look_at(AdmittedRaster input, const std::filesystem::path& file, const InputOptions& options);
[[nodiscard]] RasterFacts look_at(const std::filesystem::path& file, const InputOptions& options);

/// Opens the admitted file again.
[[nodiscard]] DatasetOwner open_dataset(const RasterFacts& facts);

/// fails  unsupported: rotation; invalid_argument: cells too small for different coordinates
void require_own_grid(const RasterFacts& facts);
/// fails  invalid_argument: neighbouring samples of the extent have the same coordinates
void require_distinct(const GridMapping& mapping, GridRect extent, const std::string& name);

}  // namespace talus
