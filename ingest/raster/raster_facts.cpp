#include "ingest/raster/raster_facts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/grid.hpp"
#include "ingest/files/ascii_grid.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "ingest/raster/crs.hpp"
#include "ingest/raster/raster_bands.hpp"
#include "ingest/raster/vertical_unit.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

constexpr double kNegligibleShear = 1e-6;  // cells, over the whole raster

struct Range {
  double low, high;
};
std::optional<Range> range_of(GDALDataType type) {
  switch (type) {
    case GDT_Byte: return Range{0, 255};
    case GDT_Int16: return Range{-32768, 32767};
    case GDT_UInt16: return Range{0, 65535};
    case GDT_Int32: return Range{-2147483648.0, 2147483647.0};
    case GDT_UInt32: return Range{0, 4294967295.0};
    default: return std::nullopt;
  }
}

void take_type(GDALRasterBandH band, RasterFacts& facts) {
  facts.type = GDALGetRasterDataType(band);
  if (!range_of(facts.type) && facts.type != GDT_Float32 && facts.type != GDT_Float64) {
    fail(Cause::unsupported,
         "{} has samples of type {}. Talus reads Byte, Int16, UInt16, Int32, UInt32, Float32 and Float64: convert it "
         "with gdal_translate -ot",
         facts.name, GDALGetDataTypeName(facts.type));
  }
  const char* signedness = GDALGetMetadataItem(band, "PIXELTYPE", "IMAGE_STRUCTURE");
  if (facts.type == GDT_Byte && signedness != nullptr && std::string_view{signedness} == "SIGNEDBYTE")
    fail(Cause::unsupported, "{} has signed bytes. Convert them with gdal_translate -ot Int16", facts.name);
}

void take_size(GDALDatasetH dataset, RasterFacts& facts) {
  facts.cols = GDALGetRasterXSize(dataset);
  facts.rows = GDALGetRasterYSize(dataset);
  if (facts.cols < 1 || facts.rows < 1 || facts.cols > kMaxExtent || facts.rows > kMaxExtent)
    refuse("{} has {} x {} samples; expected 1 to {} a side", facts.name, facts.cols, facts.rows, kMaxExtent);
}

constexpr std::array<double, 6> kNoGeotransform{0, 1, 0, 0, 0, 1};  // GDAL's answer if a file has none

/// Control points on a grid are as good as a geotransform.
bool has_grid_of_control_points(GDALDatasetH dataset, std::array<double, 6>& geotransform) {
  const int count = GDALGetGCPCount(dataset);
  return count > 0 && GDALGCPsToGeoTransform(count, GDALGetGCPs(dataset), geotransform.data(), FALSE) != 0;
}

/// The position that a raster has instead of a geotransform, in words.
std::string other_position_of(GDALDatasetH dataset) {
  if (const int count = GDALGetGCPCount(dataset); count > 0) return fmt::format("{} ground control points", count);
  if (GDALGetMetadata(dataset, "RPC") != nullptr) return "the coefficients of a camera (RPC)";
  if (GDALGetMetadata(dataset, "GEOLOCATION") != nullptr) return "arrays of longitudes and latitudes (GEOLOCATION)";
  return "";
}

void read_placement(GDALDatasetH dataset, RasterFacts& facts) {
  std::array<double, 6>& t = facts.geotransform;
  facts.mapping = {0.5, -0.5, 1, -1};
  if (GDALGetGeoTransform(dataset, t.data()) != CE_None || t == kNoGeotransform) {
    if (!has_grid_of_control_points(dataset, t)) {
      t = kNoGeotransform;
      facts.other_position = other_position_of(dataset);
      if (facts.other_position.empty()) {
        facts.notes.push_back(
            "states no position: its samples count from 0,0, columns to the right and rows downwards");
      }
      return;
    }
    facts.notes.push_back("states its position by ground control points, which lie on a grid");
  }

  if (!std::all_of(t.begin(), t.end(), [](double v) { return std::isfinite(v); }))
    refuse("{} has a geotransform that is not finite", facts.name);
  facts.is_placed = true;
  const double cols = facts.cols, rows = facts.rows;
  facts.is_rotated = std::abs(t[2]) * rows > kNegligibleShear * std::abs(t[1]) ||
                     std::abs(t[4]) * cols > kNegligibleShear * std::abs(t[5]);
  if (facts.is_rotated) return;
  facts.is_mirrored = t[1] < 0;
  facts.is_south_up = t[5] > 0;
  GridMapping& m = facts.mapping = {t[0] + 0.5 * t[1], t[3] + 0.5 * t[5], t[1], t[5]};
  if (facts.is_mirrored) {
    m.x0 += (cols - 1) * m.dx, m.dx = -m.dx;
    facts.notes.push_back("columns run west; Talus reversed them");
  }
  if (facts.is_south_up) {
    m.y0 += (rows - 1) * m.dy, m.dy = -m.dy;
    facts.notes.push_back("rows run north; Talus reversed them");
  }
  const char* point = GDALGetMetadataItem(dataset, "AREA_OR_POINT", nullptr);
  if (point != nullptr && EQUAL(point, "Point")) {
    facts.notes.push_back("PixelIsPoint: its coordinates are those of samples, not of pixel corners");
  }
}

/// Refuses coordinate systems and positions that no map of heights has.
void require_possible(const RasterFacts& facts) {
  const OGRSpatialReference crs = crs_from(facts.crs_wkt);
  GdalScope gdal;
  if (crs.IsGeocentric() != 0)
    fail(Cause::unsupported, "{} is in geocentric coordinates. Project it with gdalwarp first", facts.name);
  OGRAxisOrientation way = OAO_Up;
  if (crs.IsCompound() != 0 && crs.GetAxis("VERT_CS", 0, &way) != nullptr && way == OAO_Down) {
    fail(Cause::unsupported,
         "{} counts depths downwards, but Talus needs heights. Change the sign of its values and give it a vertical "
         "coordinate system of heights",
         facts.name);
  }
  if (crs.IsGeographic() == 0 || !facts.is_placed || facts.is_rotated) return;
  const GridMapping& m = facts.mapping;
  const double quarter = full_turn(facts.crs_wkt) / 4, north = m.y0, south = m.y(facts.rows - 1);
  const double beyond = std::max(std::abs(north), std::abs(south)) - quarter;
  const double far = std::max(std::abs(m.x0), std::abs(m.x(facts.cols - 1)));
  if (!(beyond <= std::abs(m.dy)) || !(far <= 12 * quarter)) {
    refuse(
        "{} spans latitudes {} to {} and longitudes {} to {}, which are not degrees. Name its coordinate system with "
        "InputOptions::srs",
        facts.name, south, north, m.x0, m.x(facts.cols - 1));
  }
}

void read_crs(GDALDatasetH dataset, const InputOptions& options, RasterFacts& facts) {
  OGRSpatialReferenceH handle = GDALGetSpatialRef(dataset);
  if (handle == nullptr && GDALGetGCPCount(dataset) > 0) handle = GDALGetGCPSpatialRef(dataset);
  if (handle != nullptr) facts.crs_wkt = wkt_of(*OGRSpatialReference::FromHandle(handle), facts.name);
  if (!options.srs.empty()) {
    const std::string said = wkt_of(options.srs, "InputOptions::srs");
    if (!facts.crs_wkt.empty() && !same_crs(said, facts.crs_wkt)) {
      facts.notes.push_back("states another coordinate system; Talus used InputOptions::srs");
    }
    facts.crs_wkt = said;
  }
  if (facts.crs_wkt.empty()) {
    facts.notes.push_back("states no coordinate system; Talus used metres (InputOptions::srs names one)");
  } else {
    require_possible(facts);
  }
}

double known_unit(const std::string& unit, const std::string& name) {
  if (const std::optional<double> metres = metres_in(unit)) return *metres;
  fail(Cause::unsupported,
       "{} has heights in \"{}\", a unit that Talus does not know. Name it with InputOptions::vertical_unit: metre, "
       "km, dm, cm, mm, foot or us-survey-foot",
       name, unit);
}

// The vertical unit of the CRS.
struct StatedUnit {
  std::string name;
  double metres = 1;
};
std::optional<StatedUnit> unit_of_crs(const std::string& wkt) {
  if (wkt.empty()) return std::nullopt;
  const OGRSpatialReference crs = crs_from(wkt);
  if (crs.IsCompound() == 0) return std::nullopt;
  GdalScope gdal;
  const char* name = nullptr;
  const double metres = crs.GetTargetLinearUnits("VERT_CS", &name);
  return StatedUnit{name == nullptr ? "" : name, metres};
}

void read_unit(GDALRasterBandH band, const InputOptions& options, RasterFacts& facts) {
  const std::string stated = GDALGetRasterUnitType(band);
  if (options.vertical_unit) {
    facts.vertical_unit = name_of(*options.vertical_unit);
    const std::optional<double> metres = metres_in(facts.vertical_unit);
    facts.metres_per_unit = metres.value();
    if (!stated.empty() && metres_in(stated) != metres) {
      facts.notes.push_back(fmt::format("states heights in \"{}\"; Talus used InputOptions::vertical_unit {}", stated,
                                        facts.vertical_unit));
    }
    return;
  }
  const std::optional<StatedUnit> of_crs = unit_of_crs(facts.crs_wkt);
  if (!stated.empty()) {
    facts.vertical_unit = stated;
    facts.metres_per_unit = known_unit(stated, facts.name);
    if (of_crs && std::abs(of_crs->metres / facts.metres_per_unit - 1) > 1e-9) {
      fail(Cause::unsupported,
           "{} states heights in \"{}\", but its coordinate system in \"{}\". Choose one with "
           "InputOptions::vertical_unit",
           facts.name, stated, of_crs->name);
    }
    return;
  }
  facts.vertical_unit = "metre";
  if (!of_crs) {
    facts.notes.push_back("states no vertical unit; Talus used metres (InputOptions::vertical_unit names another)");
  } else if (of_crs->metres != 1) {
    facts.vertical_unit = of_crs->name;
    const std::optional<double> known = metres_in(of_crs->name);  // the exact factor
    facts.metres_per_unit = known && std::abs(*known / of_crs->metres - 1) < 1e-9 ? *known : of_crs->metres;
  }
}

double scale_or_offset(double value, bool is_scale, const std::string& name) {
  if (std::isfinite(value) && (!is_scale || value != 0)) return value;
  refuse("{} has a band {} of {}; expected a finite number{}", name, is_scale ? "scale" : "offset", value,
         is_scale ? " other than 0" : "");
}

/// The value as a sample of the type; empty if the type cannot hold it.
std::optional<double> as_sample(double value, GDALDataType type) {
  if (const std::optional<Range> range = range_of(type)) {
    if (value >= range->low && value <= range->high && value == std::nearbyint(value)) return value;
    return std::nullopt;
  }
  if (type == GDT_Float64 || !std::isfinite(value)) return value;
  if (std::abs(value) > double{std::numeric_limits<float>::max()} * (1 + 1e-7)) return std::nullopt;
  return static_cast<double>(static_cast<float>(value));
}

void read_voids(GDALRasterBandH band, const InputOptions& options, RasterFacts& facts) {
  // Whether there is a mask besides the void value and alpha.
  const int flags = GDALGetMaskFlags(band);
  facts.masked = (flags & (GMF_ALL_VALID | GMF_ALPHA)) == 0 && flags != GMF_NODATA;
  std::vector<std::string> kinds;
  int declared = 0;
  const double value = GDALGetRasterNoDataValue(band, &declared);
  if (declared != 0 && facts.decode == ColourCode::none) {
    if (const std::optional<double> sample = as_sample(value, facts.type)) {
      if (!std::isnan(*sample)) facts.nodata = *sample;
    } else {
      facts.notes.push_back(fmt::format("the void value {} does not fit the sample type {}, so it makes no sample void",
                                        value, GDALGetDataTypeName(facts.type)));
    }
    kinds.push_back(fmt::format("{}", value));
  } else {
    for (const double said : options.nodata) {
      // If colours encode heights, users know the height, not the raw number.
      const double raw = facts.decode == ColourCode::none ? said : std::round((said - facts.offset) / facts.scale);
      const std::optional<double> sample = as_sample(raw, facts.type);
      if (!sample) continue;
      if (!std::isnan(*sample)) facts.assumed_voids.push_back(*sample);
      kinds.push_back(fmt::format("{}", said));
    }
  }
  if (facts.masked) kinds.emplace_back("mask");
  if (!facts.alphas.empty()) kinds.emplace_back("alpha");
  facts.void_text = fmt::format("{}", fmt::join(kinds, " and "));
}

std::uint64_t block_bytes_of(GDALDatasetH dataset) {
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  if (band == nullptr) return 0;
  int cols = 0, rows = 0;
  GDALGetBlockSize(band, &cols, &rows);
  // GDAL reads blocks of interleaved bands together.
  return static_cast<std::uint64_t>(cols) * static_cast<std::uint64_t>(rows) *
         static_cast<std::uint64_t>(GDALGetDataTypeSizeBytes(GDALGetRasterDataType(band))) *
         static_cast<std::uint64_t>(GDALGetRasterCount(dataset));
}

/// The largest block of a dataset and, if it is a virtual raster, of its sources.
std::uint64_t largest_block(GDALDatasetH dataset, const InputOptions& options) {
  std::uint64_t largest = block_bytes_of(dataset);
  if (std::string_view(GDALGetDriverShortName(GDALGetDatasetDriver(dataset))) != "VRT") return largest;
  const CPLStringList files{GDALGetFileList(dataset)};
  for (int i = 1; i < files.Count(); ++i) {  // the first is the dataset
    try {
      const AdmittedRaster joined = admit_raster(files[i], options);
      if (joined.dataset && GDALGetRasterCount(joined.dataset.get()) > 0)
        largest = std::max(largest, largest_block(joined.dataset.get(), options));
    } catch (const Failure&) {  // an overview or the like
    }
  }
  return largest;
}

}  // namespace

DatasetOwner open_dataset(const RasterFacts& facts) {
  GdalScope gdal;
  if (is_of_hdf5(facts.driver)) quiet_hdf5();
  const std::array<const char*, 2> only{facts.driver.c_str(), nullptr};
  DatasetOwner dataset{GDALOpenEx(name_to_open(facts.file, facts.driver, facts.variable).c_str(),
                                  GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR, only.data(), nullptr, nullptr)};
  if (!dataset)
    fail_in(facts.name, Cause::unsupported, "cannot open {} as {}{}", facts.name, facts.driver, gdal.reason());
  return dataset;
}

namespace {

/// A virtual raster must declare the voids of its sources; otherwise void samples would become heights.
void require_all_voids(const AdmittedRaster& input, GDALRasterBandH band, const RasterFacts& facts) {
  const bool has_transparency = facts.masked || !facts.alphas.empty();
  const std::string& hidden = input.alpha_in.empty() ? input.voids_in : input.alpha_in;
  if (input.interpolates && (has_transparency || !input.alpha_in.empty() || facts.decode != ColourCode::none)) {
    fail(Cause::unsupported,
         "{} is a virtual raster that interpolates its sources: {} would change the heights nearby. Name the sources "
         "as inputs, and choose InputOptions::resampling",
         facts.name, facts.decode != ColourCode::none ? "colours" : "transparent or masked samples");
  }
  int declares = 0;
  GDALGetRasterNoDataValue(band, &declares);
  if (has_transparency || (declares != 0 && input.alpha_in.empty()) || hidden.empty()) return;
  fail(Cause::unsupported,
       "{} is a virtual raster without {} of its source {}. Make it again by gdalbuildvrt without -b, or name the "
       "sources as inputs",
       facts.name, input.alpha_in.empty() ? "the void value" : "the mask or alpha", hidden);
}

/// Refuses a TIFF with blocks beyond its end. GDAL reads zeros if none is left.
void require_whole_tiff(GDALDatasetH dataset, const std::string& name, std::uint64_t bytes) {
  for (int i = 1; i <= GDALGetRasterCount(dataset); ++i) {
    GDALRasterBandH band = GDALGetRasterBand(dataset, i);
    int cols = 1, rows = 1;
    GDALGetBlockSize(band, &cols, &rows);
    const int x = (GDALGetRasterXSize(dataset) - 1) / cols, y = (GDALGetRasterYSize(dataset) - 1) / rows;
    const auto number = [&](const char* what) -> std::uint64_t {
      const char* text = GDALGetMetadataItem(band, fmt::format("BLOCK_{}_{}_{}", what, x, y).c_str(), "TIFF");
      return text == nullptr ? 0 : std::strtoull(text, nullptr, 10);
    };
    if (number("OFFSET") + number("SIZE") > bytes)
      fail_in(name, Cause::unsupported, "{} is cut short: its last samples lie beyond the end of the file", name);
  }
}

}  // namespace

AdmittedRaster open_input(const fs::path& file, const InputOptions& options) {
  return blaming(file, [&] {
    AdmittedRaster admitted = admit_raster(file, options);
    if (!admitted.dataset) {
      RasterFacts facts;
      facts.file = admitted.file;
      facts.name = file.string();
      facts.driver = admitted.driver;
      admitted.dataset = open_dataset(facts);  // fails and says why
    }
    const GdalScope gdal;
    if (admitted.driver == "GTiff")
      require_whole_tiff(admitted.dataset.get(), file.string(), admitted.files.front().bytes);
    return admitted;
  });
}

RasterFacts look_at(const fs::path& file, const InputOptions& options) {
  return look_at(open_input(file, options), file, options);
}

RasterFacts look_at(AdmittedRaster input, const fs::path& file, const InputOptions& options) {
  return blaming(file, [&] {
    RasterFacts facts;
    facts.file = input.file;
    facts.name = file.string();
    facts.driver = input.driver;
    facts.variable = input.variable;
    facts.bytes = input.files.front().bytes;
    facts.files = std::move(input.files);
    GdalScope gdal;
    GDALDatasetH dataset = input.dataset.get();
    take_band(dataset, options, facts);
    GDALRasterBandH band = GDALGetRasterBand(dataset, facts.band);
    take_type(band, facts);
    take_size(dataset, facts);
    facts.block_bytes = largest_block(dataset, options);
    read_placement(dataset, facts);
    read_crs(dataset, options, facts);
    read_unit(band, options, facts);
    facts.scale = scale_or_offset(GDALGetRasterScale(band, nullptr), true, facts.name);
    facts.offset = scale_or_offset(GDALGetRasterOffset(band, nullptr), false, facts.name);
    take_colour_code(facts);
    read_voids(band, options, facts);
    require_all_voids(input, band, facts);
    if (facts.driver == "AAIGrid") require_whole_ascii_grid(facts.file, facts.name, facts.cols, facts.rows);
    return facts;
  });
}

void require_distinct(const GridMapping& m, GridRect extent, const std::string& name) {
  bool distinct = m.dx > 0 && m.dy < 0;
  for (const GridPoint p : {extent.first, extent.last}) {
    const double x = m.x(p.col), y = m.y(p.row);
    distinct = distinct && std::isfinite(x) && std::isfinite(y) && x + m.dx != x && y + m.dy != y;
  }
  if (!distinct)
    refuse("{} has cells of {} x {} at {}, {}: too small for different coordinates", name, m.dx, -m.dy, m.x0, m.y0);
}

void require_own_grid(const RasterFacts& facts) {
  if (facts.is_rotated) {
    const std::array<double, 6>& t = facts.geotransform;
    fail(Cause::unsupported,
         "{} is rotated or sheared (geotransform {}, {}, {}, {}, {}, {}). Resample it with InputOptions::target_srs, "
         "InputOptions::target_dx or gdalwarp",
         facts.name, t[0], t[1], t[2], t[3], t[4], t[5]);
  }
  require_distinct(facts.mapping, {{0, 0}, {facts.cols - 1, facts.rows - 1}}, facts.name);
}

}  // namespace talus
