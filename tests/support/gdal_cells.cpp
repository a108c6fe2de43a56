#include "tests/support/gdal_cells.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "talus/database.hpp"

namespace talus::support {
namespace {

void check(CPLErr outcome) {
  if (outcome != CE_None) throw std::runtime_error(CPLGetLastErrorMsg());
}

double cell(GDALRasterBand* band, int col, int row) {
  double value = 0;
  check(band->RasterIO(GF_Read, col, row, 1, 1, &value, 1, 1, GDT_Float64, 0, 0));
  return value;
}

}  // namespace

int Cells::voids() const { return static_cast<int>(std::count(heights.begin(), heights.end(), std::nullopt)); }

Cells cells_of(const std::filesystem::path& file) {
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> dataset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
  if (!dataset) throw std::runtime_error(file.string() + ": " + CPLGetLastErrorMsg());
  GDALRasterBand* heights = nullptr;
  std::vector<GDALRasterBand*> alphas;
  for (int i = 1; i <= dataset->GetRasterCount(); ++i) {
    GDALRasterBand* band = dataset->GetRasterBand(i);
    if (band->GetColorInterpretation() == GCI_AlphaBand) {
      alphas.push_back(band);
    } else if (heights == nullptr) {
      heights = band;
    }
  }
  Cells cells{dataset->GetRasterXSize(), dataset->GetRasterYSize(), {}};
  for (int row = 0; row < cells.rows; ++row) {
    for (int col = 0; col < cells.cols; ++col) {
      const double value = cell(heights, col, row);
      bool is_data = !std::isnan(value) && cell(heights->GetMaskBand(), col, row) != 0;
      for (GDALRasterBand* alpha : alphas) is_data = is_data && cell(alpha, col, row) != 0;
      cells.heights.push_back(is_data ? std::optional(value * heights->GetScale() + heights->GetOffset())
                                      : std::nullopt);
    }
  }
  return cells;
}

Cells cells_of_database(const std::filesystem::path& file) {
  const Snapshot now = Database::open(file).snapshot();
  const SampleWindow window = now.samples(now.description().extent);
  Cells cells{static_cast<int>(window.region.cols()), static_cast<int>(window.region.rows()), {}};
  for (std::size_t i = 0; i < window.values.size(); ++i)
    cells.heights.push_back(window.valid[i] != 0 ? std::optional(window.values[i]) : std::nullopt);
  return cells;
}

int different(const Cells& a, const Cells& b) {
  if (a.cols != b.cols || a.rows != b.rows) return std::max(1, a.cols * a.rows);
  int count = 0;
  for (std::size_t i = 0; i < a.heights.size(); ++i) count += a.heights[i] != b.heights[i] ? 1 : 0;
  return count;
}

void write_bands(const std::filesystem::path& file, int cols, int rows, const std::vector<Band>& bands,
                 const BandsOptions& options) {
  GDALAllRegister();
  // Through memory: PNG and others are only made as copies.
  const std::unique_ptr<GDALDataset> dataset(GetGDALDriverManager()->GetDriverByName("MEM")->Create(
      "", cols, rows, static_cast<int>(bands.size()), options.type, nullptr));
  if (options.geotransform) {
    std::array<double, 6> geotransform = *options.geotransform;
    check(dataset->SetGeoTransform(geotransform.data()));
  }
  if (!options.crs.empty()) {
    OGRSpatialReference crs;
    if (crs.SetFromUserInput(options.crs.c_str()) != OGRERR_NONE) throw std::runtime_error("no CRS " + options.crs);
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    check(dataset->SetSpatialRef(&crs));
  }
  for (std::size_t i = 0; i < bands.size(); ++i) {
    GDALRasterBand* band = dataset->GetRasterBand(static_cast<int>(i) + 1);
    std::vector<double> samples = bands[i].samples;
    check(band->RasterIO(GF_Write, 0, 0, cols, rows, samples.data(), cols, rows, GDT_Float64, 0, 0));
    check(band->SetColorInterpretation(bands[i].meaning));
    if (options.nodata) check(band->SetNoDataValue(*options.nodata));
  }
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(options.driver);
  const std::unique_ptr<GDALDataset> copy(
      driver->CreateCopy(file.c_str(), dataset.get(), 0, nullptr, nullptr, nullptr));
  if (!copy) throw std::runtime_error(file.string() + ": " + CPLGetLastErrorMsg());
}

}  // namespace talus::support
