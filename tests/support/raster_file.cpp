#include "tests/support/raster_file.hpp"

#include <cstdlib>
#include <limits>
#include <memory>
#include <stdexcept>
#include <unordered_set>

#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <unistd.h>

namespace talus::support {
namespace {

struct TypeInfo {
  const char* name;
  GDALDataType gdal;
  double low, high;  ///< of integers; 0, 0 for floats
};

const TypeInfo& info(SampleType type) {
  static const TypeInfo table[] = {
      {"Byte", GDT_Byte, 0, 255},
      {"Int16", GDT_Int16, -32768, 32767},
      {"UInt16", GDT_UInt16, 0, 65535},
      {"Int32", GDT_Int32, -2147483648.0, 2147483647.0},
      {"UInt32", GDT_UInt32, 0, 4294967295.0},
      {"Float32", GDT_Float32, 0, 0},
      {"Float64", GDT_Float64, 0, 0},
  };
  return table[static_cast<std::size_t>(type)];
}

/// A value for voids that no valid sample has.
double free_value(const Terrain& terrain, SampleType type) {
  std::unordered_set<double> taken;
  for (std::size_t i = 0; i < terrain.values.size(); ++i) {
    if (terrain.valid[i] != 0) taken.insert(terrain.values[i]);
  }
  const TypeInfo& about = info(type);
  if (about.low == about.high) return -9999.25;
  for (double value = about.low;; ++value) {
    if (value > about.high) throw std::runtime_error("every value is taken: no nodata value is free");
    if (taken.count(value) == 0) return value;
  }
}

std::unique_ptr<GDALDataset> checked(GDALDataset* dataset, const std::filesystem::path& file) {
  if (dataset == nullptr) throw std::runtime_error(file.string() + ": " + CPLGetLastErrorMsg());
  return std::unique_ptr<GDALDataset>(dataset);
}

void check(CPLErr outcome) {
  if (outcome != CE_None) throw std::runtime_error(CPLGetLastErrorMsg());
}

}  // namespace

const char* to_string(SampleType type) { return info(type).name; }

Terrain fit(Terrain terrain, SampleType type) {
  const TypeInfo& about = info(type);
  for (double& value : terrain.values) {
    if (type == SampleType::float32) value = static_cast<double>(static_cast<float>(value));
    if (about.low != about.high) value = std::clamp(std::round(value), about.low, about.high) + 0.0;
  }
  return terrain;
}

void write_raster(const Terrain& terrain, const std::filesystem::path& file, const RasterOptions& options) {
  GDALAllRegister();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  const auto dataset =
      checked(driver->Create(file.c_str(), terrain.cols, terrain.rows, 1, info(options.type).gdal, nullptr), file);
  auto geotransform = options.geotransform;
  check(dataset->SetGeoTransform(geotransform.data()));
  if (!options.crs.empty()) {
    OGRSpatialReference crs;
    if (crs.SetFromUserInput(options.crs.c_str()) != OGRERR_NONE) throw std::runtime_error("no CRS " + options.crs);
    check(dataset->SetSpatialRef(&crs));
  }
  GDALRasterBand* band = dataset->GetRasterBand(1);
  if (!options.unit.empty()) check(band->SetUnitType(options.unit.c_str()));
  if (options.scale != 1 || options.offset != 0) {
    check(band->SetScale(options.scale));
    check(band->SetOffset(options.offset));
  }
  std::vector<double> values = terrain.values;
  if (terrain.has_voids() || options.nodata) {
    const double nodata = options.nodata ? *options.nodata : free_value(terrain, options.type);
    check(band->SetNoDataValue(nodata));
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (terrain.valid[i] == 0) values[i] = nodata;
    }
  }
  check(band->RasterIO(GF_Write, 0, 0, terrain.cols, terrain.rows, values.data(), terrain.cols, terrain.rows,
                       GDT_Float64, 0, 0));
}

Terrain read_raster(const std::filesystem::path& file) {
  GDALAllRegister();
  const auto dataset = checked(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR), file);
  GDALRasterBand* band = dataset->GetRasterBand(1);
  Terrain terrain(dataset->GetRasterXSize(), dataset->GetRasterYSize());
  check(band->RasterIO(GF_Read, 0, 0, terrain.cols, terrain.rows, terrain.values.data(), terrain.cols, terrain.rows,
                       GDT_Float64, 0, 0));
  int has_nodata = 0;
  double nodata = band->GetNoDataValue(&has_nodata);
  if (band->GetRasterDataType() == GDT_Float32) nodata = static_cast<double>(static_cast<float>(nodata));
  for (std::size_t i = 0; i < terrain.values.size(); ++i) {
    const double value = terrain.values[i];
    terrain.valid[i] = std::isnan(value) || (has_nodata != 0 && value == nodata) ? 0 : 1;
  }
  return terrain;
}

Terrain crop(const Terrain& terrain, int col, int row, int cols, int rows) {
  Terrain part(cols, rows);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      part.at(c, r) = terrain.at(col + c, row + r);
      part.valid[part.index(c, r)] = terrain.valid[terrain.index(col + c, row + r)];
    }
  }
  return part;
}

TempFolder::TempFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "talus-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder: " + pattern);
  path_ = pattern;
}

TempFolder::~TempFolder() {
  std::error_code ignored;  // a folder left behind in /tmp must not end the test run
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace talus::support
