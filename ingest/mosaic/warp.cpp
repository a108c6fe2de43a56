#include "ingest/mosaic/warp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_alg.h>
#include <gdalwarper.h>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/grid.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "ingest/mosaic/common_grid.hpp"
#include "ingest/raster/crs.hpp"

namespace talus {
namespace {

constexpr double kWarpMemory = 32.0 * (1 << 20);
constexpr double kTransformTolerance = 0.01;  // cells: GDAL interpolates between transformed points

struct FreeTransformer {
  void operator()(void* transformer) const { GDALDestroyTransformer(transformer); }
};
using Transformer = std::unique_ptr<void, FreeTransformer>;

struct FreeWarpOptions {
  void operator()(GDALWarpOptions* options) const { GDALDestroyWarpOptions(options); }
};

std::string name_of(const LaidRasters& laid) { return name_of_all(laid.members.front().name, laid.members.size()); }

[[noreturn]] void refuse(const LaidRasters& laid, const GdalScope& gdal) {
  fail_in(laid.members.front().name, Cause::unsupported, "{} cannot be resampled to the target grid{}", name_of(laid),
          gdal.reason());
}

// Transforms cells of the source to coordinates of the target.
Transformer transformer_of(GDALDatasetH source, const LaidRasters& laid, const std::string& source_crs,
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
  if (!transformer) refuse(laid, gdal);
  return transformer;
}

std::array<double, 6> geotransform_of(const GridMapping& m, GridPoint first) {
  return {m.x(first.col) - 0.5 * m.dx, m.dx, 0, m.y(first.row) - 0.5 * m.dy, 0, m.dy};
}

// The CRS of the source. If it equals the target's, the target's own text, so that GDAL transforms nothing.
std::string source_crs_of(const LaidRasters& laid, const std::string& target_crs) {
  if (laid.crs_wkt.empty()) return laid.crs_wkt;
  const std::string flat = wkt_of(horizontal(crs_from(laid.crs_wkt)), name_of(laid));
  return same_crs(flat, target_crs) ? target_crs : flat;
}

struct Suggestion {
  std::array<double, 6> geotransform{};
  std::array<double, 4> extent{};  // west, south, east, north
  int cols = 0, rows = 0;
};

Suggestion suggestion_of(const LaidRasters& laid, GridRect part, const std::string& source_crs,
                         const std::string& target_crs) {
  GdalScope gdal;
  const DatasetOwner source = open_laid(laid, part);
  const Transformer transformer = transformer_of(source.get(), laid, source_crs, target_crs, gdal);
  Suggestion suggestion;
  if (GDALSuggestedWarpOutput2(source.get(), GDALGenImgProjTransform, transformer.get(), suggestion.geotransform.data(),
                               &suggestion.cols, &suggestion.rows, suggestion.extent.data(), 0) != CE_None) {
    refuse(laid, gdal);
  }
  return suggestion;
}

GDALDataType type_of_result(GDALDataType type, GDALResampleAlg method) {
  if (method == GRA_NearestNeighbour) return type;
  const bool fits_float = type == GDT_Byte || type == GDT_Int16 || type == GDT_UInt16 || type == GDT_Float32;
  return fits_float ? GDT_Float32 : GDT_Float64;
}

DatasetOwner warped_band(GDALDatasetH source, int band, GDALResampleAlg method, GDALDataType type,
                         const LaidRasters& laid) {
  GdalScope gdal;
  const int cols = static_cast<int>(laid.place.cols()), rows = static_cast<int>(laid.place.rows());
  std::array<double, 6> geotransform = geotransform_of(laid.target, laid.place.first);

  std::unique_ptr<GDALWarpOptions, FreeWarpOptions> options{GDALCreateWarpOptions()};
  options->hSrcDS = source;
  options->eResampleAlg = method;
  options->eWorkingDataType = type;
  options->dfWarpMemoryLimit = kWarpMemory;
  options->nBandCount = 1;
  options->panSrcBands = static_cast<int*>(CPLMalloc(sizeof(int)));
  options->panDstBands = static_cast<int*>(CPLMalloc(sizeof(int)));
  options->panSrcBands[0] = band;
  options->panDstBands[0] = 1;
  options->nDstAlphaBand = 2;
  // The same scale for all blocks. Otherwise GDAL would choose one for each block.
  CPLStringList words;
  words.SetNameValue("INIT_DEST", "0");
  words.SetNameValue("XSCALE", fmt::format("{}", laid.x_scale).c_str());
  words.SetNameValue("YSCALE", fmt::format("{}", laid.y_scale).c_str());
  options->papszWarpOptions = words.StealList();

  Transformer transformer = transformer_of(source, laid, laid.source_crs, laid.target_crs, gdal);
  GDALSetGenImgProjTransformerDstGeoTransform(transformer.get(), geotransform.data());
  options->pfnTransformer = GDALGenImgProjTransform;
  if (laid.source_crs != laid.target_crs) {
    void* approximate = GDALCreateApproxTransformer(GDALGenImgProjTransform, transformer.get(), kTransformTolerance);
    if (approximate == nullptr) refuse(laid, gdal);
    GDALApproxTransformerOwnsSubtransformer(approximate, TRUE);
    static_cast<void>(transformer.release());
    transformer.reset(approximate);
    options->pfnTransformer = GDALApproxTransform;
  }
  options->pTransformerArg = transformer.get();

  // It owns the transformer from here on, and a reference to the source.
  DatasetOwner warped{GDALCreateWarpedVRT(source, cols, rows, geotransform.data(), options.get())};
  if (!warped) refuse(laid, gdal);
  static_cast<void>(transformer.release());
  if (GDALGetRasterCount(warped.get()) != 2 || GDALGetRasterDataType(GDALGetRasterBand(warped.get(), 1)) != type)
    refuse(laid, gdal);
  return warped;
}

}  // namespace

GDALResampleAlg algorithm_of(Resampling resampling) {
  switch (resampling) {
    case Resampling::near: return GRA_NearestNeighbour;
    case Resampling::cubic: return GRA_Cubic;
    case Resampling::average: return GRA_Average;
    case Resampling::bilinear: break;
  }
  return GRA_Bilinear;
}

const char* name_of(Resampling resampling) {
  switch (resampling) {
    case Resampling::near: return "near";
    case Resampling::cubic: return "cubic";
    case Resampling::average: return "average";
    case Resampling::bilinear: break;
  }
  return "bilinear";
}

GridMapping suggested_grid(const LaidRasters& laid, const std::string& target_crs) {
  const Suggestion s = suggestion_of(laid, laid.extent, source_crs_of(laid, target_crs), target_crs);
  const std::array<double, 6>& t = s.geotransform;
  return {t[0] + 0.5 * t[1], t[3] + 0.5 * t[5], t[1], t[5]};
}

GridRect place_of(const LaidRasters& laid, GridRect part) {
  const GridMapping& target = laid.target;
  const Suggestion s = suggestion_of(laid, part, laid.source_crs, laid.target_crs);
  // The samples inside the raster or on its edge.
  constexpr double kOnTheEdge = 1e-6;
  const double west = std::ceil((s.extent[0] - target.x0) / target.dx - kOnTheEdge);
  const double east = std::floor((s.extent[2] - target.x0) / target.dx + kOnTheEdge);
  const double north = std::ceil((s.extent[3] - target.y0) / target.dy - kOnTheEdge);
  const double south = std::floor((s.extent[1] - target.y0) / target.dy + kOnTheEdge);
  const double limit = kMaxExtent;
  if (!(west >= -limit && east <= limit && north >= -limit && south <= limit)) {
    fail_in(laid.members.front().name, Cause::invalid_argument,
            "{} would need columns {} to {}, rows {} to {} of the target grid, but a database has at most {} a side. "
            "Choose larger cells with InputOptions::target_dx",
            name_of(laid), west, east, north, south, kMaxExtent);
  }
  if (west > east || north > south) {
    fail_in(laid.members.front().name, Cause::invalid_argument,
            "{} holds no sample of the target grid: it is smaller than a cell (choose smaller cells with "
            "InputOptions::target_dx), or it crosses the edge of the target coordinate system (choose another)",
            name_of(laid));
  }
  return {{static_cast<std::int32_t>(west), static_cast<std::int32_t>(north)},
          {static_cast<std::int32_t>(east), static_cast<std::int32_t>(south)}};
}

void plan_warp(LaidRasters& laid, const std::string& target_crs, const GridMapping& target, GDALResampleAlg method) {
  laid.source_crs = source_crs_of(laid, target_crs);
  laid.target_crs = target_crs;
  laid.target = target;
  laid.method = method;
  laid.type_of_result = type_of_result(laid.type, method);
  laid.place = place_of(laid, laid.extent);
  laid.x_scale = static_cast<double>(laid.place.cols()) / static_cast<double>(laid.extent.cols());
  laid.y_scale = static_cast<double>(laid.place.rows()) / static_cast<double>(laid.extent.rows());
}

WarpedBands warp_dataset(GDALDatasetH source, const LaidRasters& laid) {
  WarpedBands warped{warped_band(source, 1, laid.method, laid.type_of_result, laid), {}};
  if (laid.members.size() > 1) warped.owners = warped_band(source, 2, GRA_NearestNeighbour, GDT_Int32, laid);
  return warped;
}

}  // namespace talus
