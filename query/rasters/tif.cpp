// Writes the surface at the samples as a GeoTIFF. Triangles are rasterized twice in strips of rows from north to south:
// first to find out whether floats hold every height, then to write.

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include "engine/machine/fail.hpp"
#include "query/rasters/raster_writers.hpp"

namespace talus {
namespace {

constexpr std::int64_t kTile = 256;                            // samples per side
constexpr std::int64_t kStripSamples = std::int64_t{1} << 21;  // the most, but at least a row of tiles
constexpr double kOnCut = 1e-12;                               // the rounding of a share at a cut of a frame

/// A closed triangle. A point in it has three shares of the corners, none below zero.
class DrawnTriangle {
 public:
  DrawnTriangle(const Mesh& mesh, const std::array<std::uint32_t, 3>& ids)
      : at_{mesh.place(ids[0]), mesh.place(ids[1]), mesh.place(ids[2])},
        height_{mesh.heights[ids[0]], mesh.heights[ids[1]], mesh.heights[ids[2]]},
        slack_(mesh.cuts.empty() ? 0 : kOnCut) {
    area_ = cross(at_[0], at_[1], at_[2]);
  }

  [[nodiscard]] double top() const { return std::min({at_[0].row, at_[1].row, at_[2].row}); }
  [[nodiscard]] double bottom() const { return std::max({at_[0].row, at_[1].row, at_[2].row}); }

  /// Calls visit(col, height) for the samples of a row in the triangle, within `columns`.
  template <class Visit>
  void for_row(std::int32_t row, std::int32_t first_col, std::int32_t last_col, Visit&& visit) const {
    if (area_ == 0) return;
    const auto [west, east] = columns_on(row);
    const auto first = static_cast<std::int32_t>(std::max<double>(first_col, std::ceil(west - 1e-6)));
    const auto last = static_cast<std::int32_t>(std::min<double>(last_col, std::floor(east + 1e-6)));
    for (std::int32_t col = first; col <= last; ++col) {
      const Place p{static_cast<double>(col), static_cast<double>(row)};
      std::array<double, 3> share{};
      bool is_in = true;
      for (std::size_t i = 0; i < 3; ++i) {
        share[i] = cross(at_[(i + 1) % 3], at_[(i + 2) % 3], p) / area_;
        is_in = is_in && share[i] >= -slack_;
      }
      if (is_in) visit(col, height_of(share));
    }
  }

 private:
  struct Columns {
    double west, east;
  };
  /// The columns where the row crosses the sides; those of all corners if it crosses none.
  [[nodiscard]] Columns columns_on(double row) const {
    Columns columns{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < 3; ++i) {
      const Place a = at_[i], b = at_[(i + 1) % 3];
      if (row < std::min(a.row, b.row) || row > std::max(a.row, b.row)) continue;
      if (a.row == b.row) {
        columns.west = std::min({columns.west, a.col, b.col});
        columns.east = std::max({columns.east, a.col, b.col});
        continue;
      }
      const double col = a.col + (row - a.row) / (b.row - a.row) * (b.col - a.col);
      columns.west = std::min(columns.west, col);
      columns.east = std::max(columns.east, col);
    }
    return columns;
  }
  /// At a corner: its own height, bit for bit.
  [[nodiscard]] double height_of(const std::array<double, 3>& share) const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (share[i] == 1) return height_[i];
    }
    return height_[0] + (share[1] * (height_[1] - height_[0]) + share[2] * (height_[2] - height_[0]));
  }
  static double cross(Place a, Place b, Place p) {
    return (b.col - a.col) * (p.row - a.row) - (b.row - a.row) * (p.col - a.col);
  }

  std::array<Place, 3> at_;
  std::array<double, 3> height_;
  double slack_, area_ = 0;
};

/// The heights of the region's samples, in strips.
class Strips {
 public:
  explicit Strips(const Mesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
    const GridRect& r = mesh.region;
    rows_ = std::max(kTile, kStripSamples / r.cols() / kTile * kTile);
    const auto bucket = [&](std::size_t t) {
      const double row = std::clamp<double>(top(t), r.first.row, r.last.row);
      return static_cast<std::size_t>(std::floor(row) - r.first.row);
    };
    std::vector<std::uint32_t> next(static_cast<std::size_t>(r.rows()) + 1, 0);
    for (std::size_t t = 0; t < order_.size(); ++t) ++next[bucket(t) + 1];
    for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
    for (std::size_t t = 0; t < order_.size(); ++t) order_[next[bucket(t)]++] = static_cast<std::uint32_t>(t);
  }

  /// Calls visit(first row, heights of whole rows) from north to south until it returns false.
  template <class Visit>
  void for_each(Visit&& visit) const {
    const GridRect& r = mesh_.region;
    std::vector<std::uint32_t> reaching;  // triangles from earlier strips that reach into this one
    std::vector<double> heights;
    std::size_t next = 0;
    for (std::int64_t first = r.first.row; first <= r.last.row; first += rows_) {
      const std::int64_t last = std::min<std::int64_t>(first + rows_ - 1, r.last.row);
      heights.assign(static_cast<std::size_t>((last - first + 1) * r.cols()), std::numeric_limits<double>::quiet_NaN());
      while (next < order_.size() && top(order_[next]) <= static_cast<double>(last)) reaching.push_back(order_[next++]);
      std::size_t kept = 0;
      for (const std::uint32_t id : reaching) {
        const DrawnTriangle facet(mesh_, mesh_.triangles[id]);
        const auto from = std::max(first, static_cast<std::int64_t>(std::ceil(facet.top())));
        const auto to = std::min(last, static_cast<std::int64_t>(std::floor(facet.bottom())));
        for (std::int64_t row = from; row <= to; ++row) {
          double* line = heights.data() + (row - first) * r.cols() - r.first.col;
          facet.for_row(static_cast<std::int32_t>(row), r.first.col, r.last.col,
                        [&](std::int32_t col, double height) { line[col] = height; });
        }
        if (facet.bottom() > static_cast<double>(last)) reaching[kept++] = id;
      }
      reaching.resize(kept);
      if (!visit(static_cast<std::int32_t>(first), heights)) return;
    }
  }

 private:
  [[nodiscard]] double top(std::size_t t) const { return DrawnTriangle(mesh_, mesh_.triangles[t]).top(); }

  const Mesh& mesh_;
  std::vector<std::uint32_t> order_;  // triangles from north to south
  std::int64_t rows_ = kTile;
};

bool floats_hold(const Strips& strips) {
  bool all = true;
  strips.for_each([&](std::int32_t, const std::vector<double>& heights) {
    all = std::all_of(heights.begin(), heights.end(),
                      [](double h) { return std::isnan(h) || static_cast<double>(static_cast<float>(h)) == h; });
    return all;
  });
  return all;
}

/// Collects GDAL's failures, because not all of its functions return them. Disables side files.
class Watch {
 public:
  explicit Watch(std::string file) : file_(std::move(file)), side_files_(setting("GDAL_PAM_ENABLED")) {
    static std::once_flag registered;
    std::call_once(registered, [] { GDALAllRegister(); });
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
    CPLPushErrorHandlerEx(hear, this);
  }
  ~Watch() {
    CPLPopErrorHandler();
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", side_files_.empty() ? nullptr : side_files_.c_str());
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// fails  full, io: if a call has failed
  void require(bool done = true) const {
    if (done && said_.empty()) return;
    fail(full_ ? Cause::full : Cause::io, "cannot write {}: {}", file_,
         said_.empty() ? "GDAL does not say why" : said_);
  }

 private:
  static std::string setting(const char* name) {
    const char* value = CPLGetThreadLocalConfigOption(name, nullptr);
    return value != nullptr ? value : "";
  }
  static void CPL_STDCALL hear(CPLErr level, CPLErrorNum, const char* sentence) {
    const int code = errno;
    auto* self = static_cast<Watch*>(CPLGetErrorHandlerUserData());
    if (level < CE_Failure || !self->said_.empty()) return;
    self->said_ = sentence;
    self->full_ = code == ENOSPC || code == EDQUOT;
  }

  std::string file_, side_files_, said_;
  bool full_ = false;
};

struct Close {
  void operator()(void* dataset) const { GDALClose(dataset); }
};

}  // namespace

void write_tif(const Mesh& mesh, const Description& description, OutputFile& out) {
  const GridRect& r = mesh.region;
  if (r.cols() < 1 || r.rows() < 1)
    throw Failure(Cause::invalid_argument, "a mesh without a region has no samples to write");
  const Strips strips(mesh);
  const GDALDataType type = floats_hold(strips) ? GDT_Float32 : GDT_Float64;

  const Watch watch(out.target().string());
  GDALDriverH driver = GDALGetDriverByName("GTiff");
  if (driver == nullptr) throw Failure(Cause::unsupported, "this GDAL writes no GeoTIFF");
  const char* const options[] = {"TILED=YES",   "BLOCKXSIZE=256",   "BLOCKYSIZE=256", "COMPRESS=DEFLATE",
                                 "PREDICTOR=3", "BIGTIFF=IF_SAFER", nullptr};
  std::unique_ptr<void, Close> raster{GDALCreate(driver, out.beside().c_str(), static_cast<int>(r.cols()),
                                                 static_cast<int>(r.rows()), 1, type, options)};
  watch.require(raster != nullptr);

  const GridMapping& m = description.mapping;  // GDAL's origin is a pixel's corner, ours its centre
  std::array<double, 6> corner{m.x(r.first.col - 0.5), m.dx, 0, m.y(r.first.row - 0.5), 0, m.dy};
  watch.require(GDALSetGeoTransform(raster.get(), corner.data()) == CE_None);
  if (!description.crs_wkt.empty())
    watch.require(GDALSetProjection(raster.get(), description.crs_wkt.c_str()) == CE_None);
  GDALRasterBandH band = GDALGetRasterBand(raster.get(), 1);
  watch.require(GDALSetRasterNoDataValue(band, std::numeric_limits<double>::quiet_NaN()) == CE_None);
  watch.require(GDALSetRasterUnitType(band, description.vertical_unit.c_str()) == CE_None);

  strips.for_each([&](std::int32_t first, std::vector<double>& heights) {
    const int rows = static_cast<int>(static_cast<std::int64_t>(heights.size()) / r.cols());
    watch.require(GDALRasterIO(band, GF_Write, 0, first - r.first.row, static_cast<int>(r.cols()), rows, heights.data(),
                               static_cast<int>(r.cols()), rows, GDT_Float64, 0, 0) == CE_None);
    return true;
  });
  GDALFlushCache(raster.get());
  watch.require();
  raster.reset();
  watch.require();
}

}  // namespace talus
