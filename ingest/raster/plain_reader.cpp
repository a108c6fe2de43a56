#include "ingest/raster/plain_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <list>
#include <utility>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/rect.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "ingest/files/input_list.hpp"
#include "ingest/files/raster_guard.hpp"

namespace talus {
namespace {

constexpr double kOnTheGrid = 1e-3;  // cells: formats round their origins
constexpr std::size_t kMostOpen = 16;

struct Placed {
  std::filesystem::path file;
  int cols = 0, rows = 0;
  GridPoint first{};  ///< the database's grid point of the file's cell (0, 0)
  /// Steps of columns and rows on the database's grid: −1 if the file runs the other way.
  std::int32_t east = 1, south = 1;
  double cell_area = 1;  ///< area of a cell, in cells of the database
  [[nodiscard]] GridRect place() const {
    const GridPoint last{first.col + east * (cols - 1), first.row + south * (rows - 1)};
    return {{std::min(first.col, last.col), std::min(first.row, last.row)},
            {std::max(first.col, last.col), std::max(first.row, last.row)}};
  }
};

/// The CRS of a dataset as text; empty if it has none.
std::string crs_of(GDALDatasetH dataset) {
  OGRSpatialReferenceH crs = GDALGetSpatialRef(dataset);
  if (crs == nullptr && GDALGetGCPCount(dataset) > 0) crs = GDALGetGCPSpatialRef(dataset);
  if (crs == nullptr) return "";
  CPLStringList options;
  options.SetNameValue("FORMAT", "WKT2_2019");
  char* text = nullptr;
  OSRExportToWktEx(crs, &text, options.List());
  std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  return wkt;
}

bool is_geographic(const std::string& wkt) {
  const OGRSpatialReferenceH crs = OSRNewSpatialReference(wkt.c_str());
  const bool is = crs != nullptr && OSRIsGeographic(crs) != 0;
  OSRDestroySpatialReference(crs);
  return is;
}

}  // namespace

struct PlainReader::Opened {
  InputOptions rules;
  std::vector<Placed> inputs;
  std::int32_t turn = 0;  ///< columns of a full turn; 0 if the CRS has no longitudes
  GridRect extent{{0, 0}, {-1, -1}};
  mutable std::list<std::pair<std::size_t, DatasetOwner>> open;  ///< the last used first

  [[nodiscard]] GDALDatasetH dataset(std::size_t input) const {
    for (auto at = open.begin(); at != open.end(); ++at) {
      if (at->first != input) continue;
      open.splice(open.begin(), open, at);
      return open.front().second.get();
    }
    AdmittedRaster raster = admit_raster(inputs[input].file, rules);
    if (!raster.dataset) fail_in(inputs[input].file, Cause::io, "cannot open {}", inputs[input].file.string());
    open.emplace_front(input, std::move(raster.dataset));
    if (open.size() > kMostOpen) open.pop_back();
    return open.front().second.get();
  }

  [[nodiscard]] GDALRasterBandH band(GDALDatasetH dataset, const std::filesystem::path& file) const {
    const int bands = GDALGetRasterCount(dataset);
    for (int i = 1; i <= bands; ++i) {
      const GDALRasterBandH one = GDALGetRasterBand(dataset, i);
      if (rules.band == 0 ? GDALGetRasterColorInterpretation(one) != GCI_AlphaBand : rules.band == i) return one;
    }
    fail_in(file, Cause::invalid_argument, "{} has no band of heights", file.string());
  }

  /// Copies the input's cells, `moved` columns further east, into the window.
  void lay(std::size_t input, std::int32_t moved, SampleWindow& window) const;
};

namespace {

double height_of_colours(ColourCode code, double red, double green, double blue) {
  if (code == ColourCode::terrarium) return red * 256 + green + blue / 256 - 32768;
  return -10000 + (red * 256 * 256 + green * 256 + blue) * 0.1;
}

/// Replaces t by the geotransform of the control points, if they lie on a grid.
void take_control_points(GDALDatasetH set, std::array<double, 6>& t) {
  std::array<double, 6> found{};
  const int count = GDALGetGCPCount(set);
  if (count > 0 && GDALGCPsToGeoTransform(count, GDALGetGCPs(set), found.data(), FALSE) != 0) t = found;
}

/// Which numbers of a band mean no data.
class VoidNumbers {
 public:
  VoidNumbers(GDALRasterBandH band, const InputOptions& rules) {
    const bool is_coded = rules.decode != ColourCode::none;
    int has_nodata = 0;
    const double stated = GDALGetRasterNoDataValue(band, &has_nodata);
    if (has_nodata != 0 && !is_coded) {
      stated_ = stated;
    } else {
      said_ = rules.nodata;
    }
    if (is_coded) apart_ = rules.decode == ColourCode::terrarium ? 1.0 / 512 : 0.05;  // half a step of the colour code
    is_float_ = GDALGetRasterDataType(band) == GDT_Float32 && !is_coded;
  }
  bool operator()(double number) const {
    constexpr double kHuge = 1e30;  // some headers round the lowest float; numbers beyond this are not heights
    if (stated_) {
      const auto is_huge = [&](double v) { return std::abs(v) > kHuge; };
      return held(number) == held(*stated_) ||
             (is_huge(*stated_) && is_huge(number) && std::signbit(number) == std::signbit(*stated_));
    }
    return std::any_of(said_.begin(), said_.end(),
                       [&](double said) { return number == held(said) || std::abs(number - said) <= apart_; });
  }

 private:
  [[nodiscard]] double held(double v) const { return is_float_ ? double{static_cast<float>(v)} : v; }

  std::optional<double> stated_;
  std::vector<double> said_;  ///< from outside, where the band states none
  double apart_ = 0;
  bool is_float_ = false;
};

template <class T>
void read_row(GDALRasterBandH band, int first, int row, int cols, GDALDataType type, T* to,
              const std::filesystem::path& file, const GdalScope& gdal) {
  if (GDALRasterIO(band, GF_Read, first, row, cols, 1, to, cols, 1, type, 0, 0) == CE_None) return;
  fail_in(file, Cause::io, "cannot read row {} of {}{}", row, file.string(), gdal.reason());
}

}  // namespace

void PlainReader::Opened::lay(std::size_t input, std::int32_t moved, SampleWindow& window) const {
  Placed in = inputs[input];
  in.first.col += moved;
  const GridRect place = in.place(), &part = window.region;
  const GridRect both = common(place, part);
  if (is_empty(both)) return;
  const GdalScope gdal;
  const GDALDatasetH set = dataset(input);
  const GDALRasterBandH heights = band(set, in.file);
  const bool is_masked = (GDALGetMaskFlags(heights) & (GMF_ALL_VALID | GMF_ALPHA)) == 0;  // alpha is read below
  const GDALRasterBandH mask = GDALGetMaskBand(heights);
  std::vector<GDALRasterBandH> alphas;
  for (int i = 1; i <= GDALGetRasterCount(set); ++i) {
    if (GDALGetRasterColorInterpretation(GDALGetRasterBand(set, i)) == GCI_AlphaBand)
      alphas.push_back(GDALGetRasterBand(set, i));
  }
  int has_scale = 0, has_offset = 0;
  const double stated_scale = GDALGetRasterScale(heights, &has_scale),
               stated_offset = GDALGetRasterOffset(heights, &has_offset);
  const bool is_coded = rules.decode != ColourCode::none;
  const double scale = has_scale != 0 && !is_coded ? stated_scale : 1,
               offset = has_offset != 0 && !is_coded ? stated_offset : 0;
  const bool is_float = GDALGetRasterDataType(heights) == GDT_Float32 && !is_coded;
  const VoidNumbers is_void_number(heights, rules);

  const int first = in.east > 0 ? both.first.col - in.first.col : in.first.col - both.last.col;
  const int cols = static_cast<int>(both.cols());
  std::vector<double> numbers(static_cast<std::size_t>(cols)), alpha(numbers.size());
  std::vector<std::uint8_t> masks(numbers.size(), 255);
  std::vector<bool> is_void(numbers.size());
  for (std::int32_t row = both.first.row; row <= both.last.row; ++row) {
    const int file_row = (row - in.first.row) * in.south;
    read_row(heights, first, file_row, cols, GDT_Float64, numbers.data(), in.file, gdal);
    if (is_coded) {
      std::vector<double> green(numbers.size()), blue(numbers.size());
      read_row(GDALGetRasterBand(set, 2), first, file_row, cols, GDT_Float64, green.data(), in.file, gdal);
      read_row(GDALGetRasterBand(set, 3), first, file_row, cols, GDT_Float64, blue.data(), in.file, gdal);
      for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = height_of_colours(rules.decode, numbers[i], green[i], blue[i]);
    }
    // A virtual raster computes in doubles, but its band holds floats.
    for (std::size_t i = 0; is_float && i < numbers.size(); ++i) numbers[i] = static_cast<float>(numbers[i]);
    if (is_masked) read_row(mask, first, file_row, cols, GDT_Byte, masks.data(), in.file, gdal);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      is_void[i] = masks[i] == 0 || std::isnan(numbers[i]) || is_void_number(numbers[i]);
    }
    for (const GDALRasterBandH band : alphas) {
      read_row(band, first, file_row, cols, GDT_Float64, alpha.data(), in.file, gdal);
      for (std::size_t i = 0; i < alpha.size(); ++i) is_void[i] = is_void[i] || alpha[i] == 0;
    }
    for (int i = 0; i < cols; ++i) {
      const auto from = static_cast<std::size_t>(i);
      if (is_void[from]) continue;
      const std::size_t to = window.index({in.first.col + in.east * (first + i), row});
      const double scaled = numbers[from] * scale;
      window.values[to] = offset != 0 ? scaled + offset : scaled;
      window.valid[to] = 1;
    }
  }
}

PlainReader::PlainReader(const std::vector<std::filesystem::path>& named, const InputOptions& rules,
                         const Description& database, const std::string& database_name)
    : opened_(std::make_unique<Opened>()) {
  opened_->rules = rules;
  const std::vector<std::filesystem::path> files = list_inputs(named, rules).files;
  const GridMapping& m = database.mapping;
  for (const std::filesystem::path& file : files) {
    const AdmittedRaster raster = admit_raster(file, rules);
    if (!raster.dataset) fail_in(file, Cause::io, "cannot open {}", file.string());
    const GdalScope gdal;
    const GDALDatasetH set = raster.dataset.get();
    const auto refuse = [&](const std::string& what) {
      fail_in(file, Cause::invalid_argument,
              "{} {}. A database can be compared only with its own inputs, and only if they were not resampled",
              file.string(), what);
    };
    if (rules.srs.empty() && !same_crs(database.crs_wkt, crs_of(set)))
      refuse(fmt::format("has another CRS than {}, or one of them has none", database_name));
    Placed placed;
    placed.file = file;
    placed.cols = GDALGetRasterXSize(set);
    placed.rows = GDALGetRasterYSize(set);
    std::array<double, 6> t{};
    if (GDALGetGeoTransform(set, t.data()) != CE_None || t == std::array<double, 6>{0, 1, 0, 0, 0, 1}) {
      t = {0, 1, 0, 0, 0, -1};  // columns and rows from the corner, downwards
      take_control_points(set, t);
    }
    if (std::abs(t[2]) * placed.rows > 1e-6 * std::abs(t[1]) || std::abs(t[4]) * placed.cols > 1e-6 * std::abs(t[5]))
      refuse(fmt::format("is rotated against the grid of {}", database_name));
    placed.cell_area = std::abs(t[1] / m.dx * t[5] / m.dy);
    placed.east = t[1] < 0 ? -1 : 1;
    placed.south = t[5] > 0 ? -1 : 1;
    const double col = (t[0] + t[1] / 2 - m.x0) / m.dx, row = (t[3] + t[5] / 2 - m.y0) / m.dy;
    const double drift =
        std::max(std::abs(std::abs(t[1] / m.dx) - 1) * placed.cols, std::abs(std::abs(t[5] / m.dy) - 1) * placed.rows);
    const double off = std::max(std::abs(col - std::nearbyint(col)), std::abs(row - std::nearbyint(row)));
    if (!(off + drift <= kOnTheGrid)) refuse(fmt::format("lies elsewhere than {}, or has other cells", database_name));
    if (!(std::abs(col) < 1e9 && std::abs(row) < 1e9)) refuse(fmt::format("lies elsewhere than {}", database_name));
    placed.first = {static_cast<std::int32_t>(std::nearbyint(col)), static_cast<std::int32_t>(std::nearbyint(row))};
    opened_->inputs.push_back(placed);
  }
  const double turn = is_geographic(database.crs_wkt) ? std::nearbyint(360 / m.dx) : 0;
  if (turn >= 1 && turn < 1e9 && std::abs(turn * m.dx - 360) <= kOnTheGrid * m.dx)
    opened_->turn = static_cast<std::int32_t>(turn);
  if (rules.priority_resolution) {  // the raster with smaller cells on top
    std::stable_sort(opened_->inputs.begin(), opened_->inputs.end(),
                     [](const Placed& a, const Placed& b) { return a.cell_area > b.cell_area * (1 + 1e-3); });
  }
  settle_extent(database.extent);
}

/// Moves inputs by a full turn of longitude to where they meet the database.
void PlainReader::settle_extent(GridRect database) {
  GridRect& all = opened_->extent;
  for (Placed& placed : opened_->inputs) {
    for (std::int32_t moved : {0, opened_->turn, -opened_->turn}) {
      GridRect one = placed.place();
      one.first.col += moved, one.last.col += moved;
      if (one.first.col > database.last.col || one.last.col < database.first.col) continue;
      placed.first.col += moved;
      break;
    }
    const GridRect one = placed.place();
    if (all.cols() < 1) all = one;
    all = {{std::min(all.first.col, one.first.col), std::min(all.first.row, one.first.row)},
           {std::max(all.last.col, one.last.col), std::max(all.last.row, one.last.row)}};
  }
  if (opened_->turn > 0 && all.cols() > opened_->turn + 1) {  // a raster may repeat its first column at its end
    all.first.col = database.first.col;
    all.last.col = std::max(database.first.col + opened_->turn - 1, std::min(all.last.col, database.last.col));
  }
}

PlainReader::~PlainReader() = default;
PlainReader::PlainReader(PlainReader&&) noexcept = default;
PlainReader& PlainReader::operator=(PlainReader&&) noexcept = default;

GridRect PlainReader::extent() const { return opened_->extent; }

SampleWindow PlainReader::read(GridRect part) const {
  SampleWindow window;
  window.region = part;
  window.values.assign(static_cast<std::size_t>(part.samples()), 0);
  window.valid.assign(window.values.size(), 0);
  for (std::size_t i = 0; i < opened_->inputs.size(); ++i) {
    opened_->lay(i, 0, window);
    if (opened_->turn == 0 || opened_->extent.cols() < opened_->turn) continue;
    opened_->lay(i, opened_->turn, window);
    opened_->lay(i, -opened_->turn, window);
  }
  return window;
}

}  // namespace talus
