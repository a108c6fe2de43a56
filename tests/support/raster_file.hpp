#pragma once
// Rasters on disk for tests, written and read through GDAL without any code of the ingest.

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/surfaces.hpp"

namespace talus::support {

enum class SampleType { uint8, int16, uint16, int32, uint32, float32, float64 };
[[nodiscard]] const char* to_string(SampleType type);

/// Everything about a file that is not its samples.
struct RasterOptions {
  SampleType type = SampleType::int16;
  /// Voids are written as this value, or as NaN with a nodata of NaN; empty: a free value is chosen.
  std::optional<double> nodata;
  std::array<double, 6> geotransform{0, 1, 0, 0, 0, -1};  ///< of the corner of the first pixel, as GDAL has it
  std::string crs;                                        ///< "EPSG:32632" or empty
  std::string unit;                                       ///< of the band; empty says nothing
  double scale = 1, offset = 0;  ///< of the band: written only if not 1 and 0; values are written raw
};

/// Rounds to what the type can hold: whole numbers in range, or the nearest float.
[[nodiscard]] Terrain fit(Terrain terrain, SampleType type);

/// Writes a GeoTIFF. Throws std::runtime_error if GDAL does. `terrain` must fit the type.
void write_raster(const Terrain& terrain, const std::filesystem::path& file, const RasterOptions& options = {});

/// The first band, plainly: nodata and NaN are void, rows as they lie in the file.
[[nodiscard]] Terrain read_raster(const std::filesystem::path& file);

/// The samples col..col+cols-1, row..row+rows-1 as a terrain of their own.
[[nodiscard]] Terrain crop(const Terrain& terrain, int col, int row, int cols, int rows);

/// A folder that is there as long as this lives.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace talus::support
