#include "ingest/raster_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <cpl_conv.h>
#include <fmt/format.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include "engine/grid.hpp"
#include "ingest/gdal_scope.hpp"
#include "ingest/raster_guard.hpp"
#include "talus/failure.hpp"
#include "talus/ingest.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostSamples = std::int64_t{1} << 34;
constexpr double kLargestHeight = 1e6;     // metres, up or down
constexpr double kNegligibleShear = 1e-6;  // cells, over the whole raster

struct CloseDataset {
  void operator()(void* dataset) const { GDALClose(dataset); }
};

bool is_integer(GDALDataType type) {
  return type == GDT_Byte || type == GDT_Int16 || type == GDT_UInt16 || type == GDT_Int32 || type == GDT_UInt32;
}

void check_type(GDALRasterBandH band, const std::string& name) {
  const GDALDataType type = GDALGetRasterDataType(band);
  if (!is_integer(type) && type != GDT_Float32 && type != GDT_Float64) {
    throw Failure(Cause::unsupported,
                  fmt::format("{} has samples of type {}; Talus takes Byte, Int16, UInt16, Int32, UInt32, Float32 and "
                              "Float64 (gdal_translate -ot converts)",
                              name, GDALGetDataTypeName(type)));
  }
  const char* signedness = GDALGetMetadataItem(band, "PIXELTYPE", "IMAGE_STRUCTURE");
  if (type == GDT_Byte && signedness != nullptr && std::string_view{signedness} == "SIGNEDBYTE") {
    throw Failure(Cause::unsupported, fmt::format("{} has signed bytes; gdal_translate -ot Int16 converts them", name));
  }
}

GridRect extent_of(GDALDatasetH dataset, const std::string& name) {
  const int cols = GDALGetRasterXSize(dataset), rows = GDALGetRasterYSize(dataset);
  if (cols < 1 || rows < 1 || cols > kMaxExtent || rows > kMaxExtent || std::int64_t{cols} * rows > kMostSamples) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("{} is {} x {} samples; at most {} a side and {} in all can be taken in", name, cols,
                              rows, kMaxExtent, kMostSamples));
  }
  return {{0, 0}, {cols - 1, rows - 1}};
}

struct Placement {
  GridMapping mapping;
  bool mirrored = false, south_up = false;
};

Placement placement_of(GDALDatasetH dataset, GridRect extent, const std::string& name) {
  std::array<double, 6> t{};
  constexpr std::array<double, 6> kNone{0, 1, 0, 0, 0, 1};  // what GDAL says where a file says nothing
  if (GDALGetGeoTransform(dataset, t.data()) != CE_None || t == kNone) return {{0.5, -0.5, 1, -1}, false, false};

  const double cols = static_cast<double>(extent.cols()), rows = static_cast<double>(extent.rows());
  if (!std::all_of(t.begin(), t.end(), [](double v) { return std::isfinite(v); })) {
    throw Failure(Cause::invalid_argument, fmt::format("{} has a geotransform that is not finite", name));
  }
  if (std::abs(t[2]) * rows > kNegligibleShear * std::abs(t[1]) ||
      std::abs(t[4]) * cols > kNegligibleShear * std::abs(t[5])) {
    throw Failure(Cause::unsupported,
                  fmt::format("{} is rotated or sheared (geotransform {}, {}, {}, {}, {}, {}); gdalwarp makes it "
                              "north-up",
                              name, t[0], t[1], t[2], t[3], t[4], t[5]));
  }
  Placement placed{{t[0] + 0.5 * t[1], t[3] + 0.5 * t[5], t[1], t[5]}, t[1]<0, t[5]> 0};
  GridMapping& m = placed.mapping;
  if (placed.mirrored) m.x0 += (cols - 1) * m.dx, m.dx = -m.dx;
  if (placed.south_up) m.y0 += (rows - 1) * m.dy, m.dy = -m.dy;
  const double x_end = m.x(extent.last.col), y_end = m.y(extent.last.row);
  const bool distinct = m.dx > 0 && m.dy < 0 && std::isfinite(x_end) && std::isfinite(y_end) && m.x0 + m.dx != m.x0 &&
                        x_end + m.dx != x_end && m.y0 + m.dy != m.y0 && y_end + m.dy != y_end;
  if (!distinct) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("{} has cells of {} x {} at {}, {}: too small for doubles to tell apart", name, m.dx,
                              -m.dy, m.x0, m.y0));
  }
  return placed;
}

std::string crs_of(GDALDatasetH dataset, const std::string& name, const GdalScope& gdal) {
  OGRSpatialReferenceH crs = GDALGetSpatialRef(dataset);
  if (crs == nullptr) return {};
  constexpr std::array<const char*, 2> kOptions{"FORMAT=WKT2_2019", nullptr};
  char* text = nullptr;
  const OGRErr status = OSRExportToWktEx(crs, &text, kOptions.data());
  std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  if (status != OGRERR_NONE) {
    throw Failure(Cause::unsupported,
                  fmt::format("{} has a coordinate system that cannot be written as WKT{}", name, gdal.reason()));
  }
  return wkt;
}

struct VerticalUnit {
  std::string_view name;
  double metres;
};
constexpr VerticalUnit kVerticalUnits[] = {{"", 1},
                                           {"m", 1},
                                           {"metre", 1},
                                           {"metres", 1},
                                           {"meter", 1},
                                           {"meters", 1},
                                           {"km", 1000},
                                           {"dm", 0.1},
                                           {"cm", 0.01},
                                           {"mm", 0.001},
                                           {"ft", 0.3048},
                                           {"foot", 0.3048},
                                           {"feet", 0.3048},
                                           {"international foot", 0.3048},
                                           {"us-ft", 1200.0 / 3937},
                                           {"ft-us", 1200.0 / 3937},
                                           {"ftus", 1200.0 / 3937},
                                           {"us survey foot", 1200.0 / 3937},
                                           {"us survey feet", 1200.0 / 3937}};

double metres_per(const std::string& unit, const std::string& name) {
  for (const VerticalUnit& known : kVerticalUnits) {
    if (unit.size() == known.name.size() && EQUALN(unit.c_str(), known.name.data(), unit.size())) return known.metres;
  }
  throw Failure(Cause::unsupported,
                fmt::format("{} has heights in \"{}\"; Talus knows m, km, dm, cm, mm, ft and us-ft (gdal_edit.py or a "
                            "virtual raster can say so)",
                            name, unit));
}

double scale_or_offset(double value, bool is_scale, const std::string& name) {
  if (std::isfinite(value) && (!is_scale || value != 0)) return value;
  throw Failure(Cause::invalid_argument,
                fmt::format("{} has a band {} of {}; it must be a finite number{}", name, is_scale ? "scale" : "offset",
                            value, is_scale ? " other than 0" : ""));
}

// The raw sample that means void, as the band's own type holds it; none where that type has no such number.
std::optional<double> nodata_of(GDALRasterBandH band) {
  int declared = 0;
  const double value = GDALGetRasterNoDataValue(band, &declared);
  if (declared == 0 || std::isnan(value)) return std::nullopt;  // NaN is void anyway
  if (GDALGetRasterDataType(band) != GDT_Float32 || std::isinf(value)) return value;
  if (std::abs(value) > double{std::numeric_limits<float>::max()} * (1 + 1e-7)) return std::nullopt;
  return static_cast<double>(static_cast<float>(value));
}

// A mask besides what the nodata value already says.
bool has_mask(GDALRasterBandH band) {
  const int flags = GDALGetMaskFlags(band);
  return (flags & GMF_ALL_VALID) == 0 && flags != GMF_NODATA;
}

template <class T>
void turn(std::vector<T>& samples, std::size_t cols, bool mirrored, bool south_up) {
  if (mirrored && south_up) {
    std::reverse(samples.begin(), samples.end());
    return;
  }
  const std::size_t rows = samples.size() / cols;
  const auto row = [&](std::size_t r) { return samples.begin() + static_cast<std::ptrdiff_t>(r * cols); };
  for (std::size_t r = 0; mirrored && r < rows; ++r) std::reverse(row(r), row(r + 1));
  for (std::size_t r = 0; south_up && r < rows / 2; ++r) std::swap_ranges(row(r), row(r + 1), row(rows - 1 - r));
}

}  // namespace

struct RasterSource::Gdal {
  std::string name;  // as failures call it
  std::unique_ptr<void, CloseDataset> dataset;
  GDALRasterBandH band = nullptr;
  GDALRasterBandH mask = nullptr;  // null where nodata says it all
  std::optional<double> nodata;
  double scale = 1, offset = 0;  // of floats; those of integers are in the step
  bool mirrored = false, south_up = false;

  template <class T>
  std::vector<T> read(GDALRasterBandH from, GDALDataType as, GridRect part) const;
};

template <class T>
std::vector<T> RasterSource::Gdal::read(GDALRasterBandH from, GDALDataType as, GridRect part) const {
  GdalScope gdal;
  const int cols = static_cast<int>(part.cols()), rows = static_cast<int>(part.rows());
  const int x = mirrored ? GDALGetRasterXSize(dataset.get()) - 1 - part.last.col : part.first.col;
  const int y = south_up ? GDALGetRasterYSize(dataset.get()) - 1 - part.last.row : part.first.row;
  std::vector<T> samples(static_cast<std::size_t>(part.samples()));
  if (GDALRasterIOEx(from, GF_Read, x, y, cols, rows, samples.data(), cols, rows, as, 0, 0, nullptr) != CE_None) {
    throw Failure(Cause::io, fmt::format("cannot read columns {} to {}, rows {} to {} of {}{}", part.first.col,
                                         part.last.col, part.first.row, part.last.row, name, gdal.reason()));
  }
  turn(samples, static_cast<std::size_t>(cols), mirrored, south_up);
  return samples;
}

RasterSource::RasterSource(const fs::path& file) : gdal_(std::make_unique<Gdal>()) {
  const AdmittedRaster admitted = admit_raster(file);
  GdalScope scope;
  const std::array<const char*, 2> only{admitted.driver.c_str(), nullptr};
  const std::string& name = gdal_->name = file.string();
  gdal_->dataset.reset(
      GDALOpenEx(admitted.file.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR, only.data(), nullptr, nullptr));
  GDALDatasetH dataset = gdal_->dataset.get();
  if (dataset == nullptr) {
    throw Failure(Cause::unsupported, fmt::format("cannot open {} as {}{}", name, admitted.driver, scope.reason()));
  }
  if (GDALGetRasterCount(dataset) < 1) {
    throw Failure(Cause::invalid_argument, fmt::format("{} has no band to take heights from", name));
  }
  GDALRasterBandH band = gdal_->band = GDALGetRasterBand(dataset, 1);
  check_type(band, name);

  Description& d = description_;
  d.extent = extent_of(dataset, name);
  const Placement placed = placement_of(dataset, d.extent, name);
  d.mapping = placed.mapping;
  gdal_->mirrored = placed.mirrored;
  gdal_->south_up = placed.south_up;
  d.crs_wkt = crs_of(dataset, name, scope);
  d.source_name = file.filename().string();
  d.source_type = GDALGetDataTypeName(GDALGetRasterDataType(band));
  const std::string unit = GDALGetRasterUnitType(band);
  d.metres_per_unit = metres_per(unit, name);
  d.vertical_unit = unit.empty() ? "metre" : unit;

  const double scale = scale_or_offset(GDALGetRasterScale(band, nullptr), true, name);
  const double offset = scale_or_offset(GDALGetRasterOffset(band, nullptr), false, name);
  if (is_integer(GDALGetRasterDataType(band))) {
    d.step = {scale, 1, offset, true};
  } else {
    d.step = {1, 1, 0, false};
    gdal_->scale = scale;
    gdal_->offset = offset;
  }
  gdal_->nodata = nodata_of(band);
  if (has_mask(band)) gdal_->mask = GDALGetMaskBand(band);
}

RasterSource::~RasterSource() = default;
RasterSource::RasterSource(RasterSource&&) noexcept = default;
RasterSource& RasterSource::operator=(RasterSource&&) noexcept = default;

int RasterSource::bands() const { return GDALGetRasterCount(gdal_->dataset.get()); }

CodeWindow RasterSource::read_codes(GridRect part) const {
  const GridRect& extent = description_.extent;
  if (part.cols() < 1 || part.rows() < 1 || !extent.contains(part.first) || !extent.contains(part.last)) {
    throw Failure(
        Cause::invalid_argument,
        fmt::format("columns {} to {}, rows {} to {} are not a part of {}, which has {} x {} samples", part.first.col,
                    part.last.col, part.first.row, part.last.row, gdal_->name, extent.cols(), extent.rows()));
  }
  CodeWindow window;
  window.region = part;
  window.codes = gdal_->read<double>(gdal_->band, GDT_Float64, part);
  window.valid = gdal_->mask ? gdal_->read<std::uint8_t>(gdal_->mask, GDT_Byte, part)
                             : std::vector<std::uint8_t>(window.codes.size(), 1);

  const HeightStep& step = description_.step;
  const double nodata = gdal_->nodata.value_or(std::numeric_limits<double>::quiet_NaN());  // equals nothing
  const double largest = kLargestHeight / description_.metres_per_unit;
  for (std::size_t i = 0; i < window.codes.size(); ++i) {
    double& code = window.codes[i];
    const bool valid = window.valid[i] != 0 && code != nodata && !std::isnan(code);
    window.valid[i] = valid ? 1 : 0;
    if (!valid) continue;
    code *= gdal_->scale;
    if (gdal_->offset != 0) code += gdal_->offset;  // -0.0 + 0 is 0
    const double value = step.integer ? step.value(code) : code;
    if (!(std::abs(value) <= largest)) {
      const auto cols = static_cast<std::size_t>(part.cols());
      throw Failure(Cause::invalid_argument,
                    fmt::format("{} holds {} {} at column {}, row {}, which is no height (at most {} m up or down); "
                                "if it means no data, declare it: gdal_translate -a_nodata",
                                gdal_->name, value, description_.vertical_unit,
                                part.first.col + static_cast<std::int64_t>(i % cols),
                                part.first.row + static_cast<std::int64_t>(i / cols), kLargestHeight));
    }
  }
  return window;
}

SampleWindow RasterSource::read(GridRect part) const {
  CodeWindow codes = read_codes(part);
  SampleWindow window{codes.region, std::move(codes.codes), std::move(codes.valid)};
  const HeightStep& step = description_.step;
  if (step.integer) {
    for (double& value : window.values) value = step.value(value);
  }
  return window;
}

// ---- the public door -----------------------------------------------------------------------------

struct Raster::Opened {
  RasterSource source;
};

Raster::Raster(const fs::path& input) : opened_(std::make_unique<Opened>(Opened{RasterSource{input}})) {}
Raster::~Raster() = default;
Raster::Raster(Raster&&) noexcept = default;
Raster& Raster::operator=(Raster&&) noexcept = default;

const Description& Raster::description() const { return opened_->source.description(); }
SampleWindow Raster::read(GridRect part) const { return opened_->source.read(part); }

}  // namespace talus
