#include "ingest/warp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_alg.h>
#include <gdalwarper.h>

#include "engine/grid.hpp"
#include "ingest/crs.hpp"
#include "ingest/gdal_scope.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr double kWarpMemory = 32.0 * (1 << 20);
constexpr double kTransformTolerance = 0.01;  // cells; between CRSs points are transformed one by one otherwise

struct FreeTransformer {
  void operator()(void* transformer) const { GDALDestroyTransformer(transformer); }
};
using Transformer = std::unique_ptr<void, FreeTransformer>;

struct FreeWarpOptions {
  void operator()(GDALWarpOptions* options) const { GDALDestroyWarpOptions(options); }
};

[[noreturn]] void refuse(const RasterFacts& facts, const GdalScope& gdal) {
  throw Failure(Cause::unsupported,
                fmt::format("{} cannot be resampled to the target grid{}", facts.name, gdal.reason()));
}

// From the source's cells to the target's coordinates, or to its cells once they are known.
Transformer transformer_of(GDALDatasetH source, const RasterFacts& facts, const std::string& source_crs,
                           const std::string& target_crs, const GdalScope& gdal) {
  CPLStringList options;
  if (source_crs != target_crs) {
    options.SetNameValue("SRC_SRS", source_crs.c_str());
    options.SetNameValue("DST_SRS", target_crs.c_str());
    options.SetNameValue("ALLOW_BALLPARK", "NO");
  } else {
    options.SetNameValue("SRC_SRS", "");
    options.SetNameValue("DST_SRS", "");
  }
  Transformer transformer{GDALCreateGenImgProjTransformer2(source, nullptr, options.List())};
  if (!transformer) refuse(facts, gdal);
  return transformer;
}

std::array<double, 6> geotransform_of(const GridMapping& m, GridPoint first) {
  return {m.x(first.col) - 0.5 * m.dx, m.dx, 0, m.y(first.row) - 0.5 * m.dy, 0, m.dy};
}

// The target's own text where it is the same CRS: then nothing is transformed.
std::string source_crs_of(const RasterFacts& facts, const std::string& target_crs) {
  if (facts.crs_wkt.empty()) return facts.crs_wkt;
  const std::string flat = wkt_of(horizontal(crs_from(facts.crs_wkt)), facts.name);
  return same_crs(flat, target_crs) ? target_crs : flat;
}

struct Suggestion {
  std::array<double, 6> geotransform{};
  std::array<double, 4> extent{};  // x and y from, x and y to
  int cols = 0, rows = 0;
};

Suggestion suggestion_of(const RasterFacts& facts, const std::string& source_crs, const std::string& target_crs) {
  GdalScope gdal;
  const DatasetOwner source = open_dataset(facts);
  const Transformer transformer = transformer_of(source.get(), facts, source_crs, target_crs, gdal);
  Suggestion suggestion;
  if (GDALSuggestedWarpOutput2(source.get(), GDALGenImgProjTransform, transformer.get(), suggestion.geotransform.data(),
                               &suggestion.cols, &suggestion.rows, suggestion.extent.data(), 0) != CE_None) {
    refuse(facts, gdal);
  }
  return suggestion;
}

GDALDataType type_of_result(const RasterFacts& facts, GDALResampleAlg method) {
  if (method == GRA_NearestNeighbour) return facts.type;
  const bool fits_float =
      facts.type == GDT_Byte || facts.type == GDT_Int16 || facts.type == GDT_UInt16 || facts.type == GDT_Float32;
  return fits_float ? GDT_Float32 : GDT_Float64;
}

double* one_value(double value) {
  auto* values = static_cast<double*>(CPLMalloc(sizeof(double)));
  *values = value;
  return values;
}

}  // namespace

GDALResampleAlg resampling_of(const std::string& word) {
  if (word.empty() || word == "bilinear") return GRA_Bilinear;
  if (word == "near") return GRA_NearestNeighbour;
  if (word == "cubic") return GRA_Cubic;
  if (word == "average") return GRA_Average;
  throw Failure(Cause::invalid_argument,
                fmt::format("--resampling {}: expected near, bilinear, cubic or average", word));
}

GridMapping suggested_grid(const RasterFacts& facts, const std::string& target_crs) {
  const Suggestion s = suggestion_of(facts, source_crs_of(facts, target_crs), target_crs);
  const std::array<double, 6>& t = s.geotransform;
  return {t[0] + 0.5 * t[1], t[3] + 0.5 * t[5], t[1], t[5]};
}

Warp plan_warp(const RasterFacts& facts, const std::string& target_crs, const GridMapping& target,
               GDALResampleAlg method) {
  Warp warp;
  warp.source_crs = source_crs_of(facts, target_crs);
  warp.target_crs = target_crs;
  warp.target = target;
  warp.method = method;
  warp.type = type_of_result(facts, method);
  const Suggestion s = suggestion_of(facts, warp.source_crs, target_crs);
  // Samples that stand inside the raster; one on its edge counts.
  constexpr double kOnTheEdge = 1e-6;
  const double west = std::ceil((s.extent[0] - target.x0) / target.dx - kOnTheEdge);
  const double east = std::floor((s.extent[2] - target.x0) / target.dx + kOnTheEdge);
  const double north = std::ceil((s.extent[3] - target.y0) / target.dy - kOnTheEdge);
  const double south = std::floor((s.extent[1] - target.y0) / target.dy + kOnTheEdge);
  const double limit = kMaxExtent;
  if (!(west >= -limit && east <= limit && north >= -limit && south <= limit)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("{} would take columns {} to {}, rows {} to {} of the target grid; at most {} a side can "
                              "be taken in: choose larger cells with --tr",
                              facts.name, west, east, north, south, kMaxExtent));
  }
  if (west > east || north > south) {
    throw Failure(
        Cause::invalid_argument,
        fmt::format("{} is smaller than a cell of the target grid: choose smaller cells with --tr", facts.name));
  }
  warp.place = {{static_cast<std::int32_t>(west), static_cast<std::int32_t>(north)},
                {static_cast<std::int32_t>(east), static_cast<std::int32_t>(south)}};
  return warp;
}

DatasetOwner warp_dataset(GDALDatasetH source, const RasterFacts& facts) {
  GdalScope gdal;
  const Warp& warp = *facts.warp;
  const int cols = static_cast<int>(warp.place.cols()), rows = static_cast<int>(warp.place.rows());
  std::array<double, 6> geotransform = geotransform_of(warp.target, warp.place.first);

  std::unique_ptr<GDALWarpOptions, FreeWarpOptions> options{GDALCreateWarpOptions()};
  options->hSrcDS = source;
  options->eResampleAlg = warp.method;
  options->eWorkingDataType = warp.type;
  options->dfWarpMemoryLimit = kWarpMemory;
  options->nBandCount = 1;
  options->panSrcBands = static_cast<int*>(CPLMalloc(sizeof(int)));
  options->panDstBands = static_cast<int*>(CPLMalloc(sizeof(int)));
  options->panSrcBands[0] = options->panDstBands[0] = 1;
  options->nDstAlphaBand = 2;
  const bool is_float = facts.type == GDT_Float32 || facts.type == GDT_Float64;
  if (!facts.masked && (facts.nodata || is_float)) {
    options->padfSrcNoDataReal = one_value(facts.nodata.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  // Every block by one and the same scale: GDAL would otherwise take that of the block.
  CPLStringList words;
  words.SetNameValue("INIT_DEST", "0");
  words.SetNameValue("XSCALE", fmt::format("{}", static_cast<double>(cols) / facts.cols).c_str());
  words.SetNameValue("YSCALE", fmt::format("{}", static_cast<double>(rows) / facts.rows).c_str());
  options->papszWarpOptions = words.StealList();

  Transformer transformer = transformer_of(source, facts, warp.source_crs, warp.target_crs, gdal);
  GDALSetGenImgProjTransformerDstGeoTransform(transformer.get(), geotransform.data());
  options->pfnTransformer = GDALGenImgProjTransform;
  if (warp.source_crs != warp.target_crs) {
    void* approximate = GDALCreateApproxTransformer(GDALGenImgProjTransform, transformer.get(), kTransformTolerance);
    if (approximate == nullptr) refuse(facts, gdal);
    GDALApproxTransformerOwnsSubtransformer(approximate, TRUE);
    static_cast<void>(transformer.release());
    transformer.reset(approximate);
    options->pfnTransformer = GDALApproxTransform;
  }
  options->pTransformerArg = transformer.get();

  // Owns the transformer from here on, and a reference to the source.
  DatasetOwner warped{GDALCreateWarpedVRT(source, cols, rows, geotransform.data(), options.get())};
  if (!warped) refuse(facts, gdal);
  static_cast<void>(transformer.release());
  if (GDALGetRasterCount(warped.get()) != 2 || GDALGetRasterDataType(GDALGetRasterBand(warped.get(), 1)) != warp.type) {
    refuse(facts, gdal);
  }
  return warped;
}

}  // namespace talus
