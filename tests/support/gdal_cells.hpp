#pragma once
// What GDAL itself reads from a raster, cell by cell, and rasters of several bands. No code of the ingest.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gdal.h>

namespace talus::support {

/// Heights as a person would read them off: row by row, empty where there is none.
struct Cells {
  int cols = 0, rows = 0;
  std::vector<std::optional<double>> heights;
  [[nodiscard]] const std::optional<double>& at(int col, int row) const {
    return heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col)];
  }
  [[nodiscard]] int voids() const;
};

/// The first band that is not alpha, scale and offset applied. Empty: what the band's mask leaves out, NaN, and where a
/// band of alpha is 0.
[[nodiscard]] Cells cells_of(const std::filesystem::path& file);

/// All samples of a database.
[[nodiscard]] Cells cells_of_database(const std::filesystem::path& file);

/// How many cells differ: one is empty and the other not, or heights are not the same double.
[[nodiscard]] int different(const Cells& a, const Cells& b);

/// A band to write.
struct Band {
  std::vector<double> samples;  ///< row by row
  GDALColorInterp meaning = GCI_Undefined;
};
struct BandsOptions {
  GDALDataType type = GDT_Float32;
  std::string crs = "EPSG:25832";                                                       ///< empty: none
  std::optional<std::array<double, 6>> geotransform{{500000, 10, 0, 5600400, 0, -10}};  ///< of the corner; empty: none
  std::optional<double> nodata = std::nullopt;
  const char* driver = "GTiff";
};
/// Throws std::runtime_error if GDAL does.
void write_bands(const std::filesystem::path& file, int cols, int rows, const std::vector<Band>& bands,
                 const BandsOptions& options = {});

}  // namespace talus::support
