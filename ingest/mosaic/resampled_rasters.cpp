#include "ingest/mosaic/resampled_rasters.hpp"

#include <vector>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/rect.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "ingest/raster/raster_source.hpp"

namespace talus {
namespace {

/// part  rectangle of the warped dataset, counted from its own first sample
template <class T>
void read_band(GDALDatasetH warped, int number, GridRect part, GDALDatasetH laid, const std::string& name,
               const Patch<T>& to) {
  GdalScope gdal;
  const int cols = static_cast<int>(to.cols), rows = static_cast<int>(to.rows);
  const CPLErr outcome =
      GDALRasterIOEx(GDALGetRasterBand(warped, number), GF_Read, part.first.col, part.first.row, cols, rows, to.samples,
                     cols, rows, kGdalType<T>, 0, static_cast<GSpacing>(to.stride * sizeof(T)), nullptr);
  rethrow_failure(laid);
  // GDAL also reports points without a place in the other CRS, which is no failure.
  if (outcome == CE_None) return;
  fail_in(name, Cause::io, "cannot resample {}{}", name, gdal.reason());
}

}  // namespace

ResampledRasters::Open& ResampledRasters::open(const LaidRasters& laid) {
  const auto [found, is_new] = open_.try_emplace(&laid);
  Open& set = found->second;
  if (is_new) {
    try {
      set.laid = open_laid(laid, laid.extent);
      set.warped = warp_dataset(set.laid.get(), laid);
    } catch (...) {
      open_.erase(found);
      throw;
    }
  }
  return set;
}

template <class T>
void ResampledRasters::read(const RasterFacts& facts, GridRect part, const RasterCoding& coding, T* codes,
                            std::size_t stride, const std::function<std::uint8_t*()>& valid_at) {
  const LaidRasters& laid = *facts.warp->laid;
  Open& set = open(laid);
  // The raster may lie a full turn away from its target.
  const std::int32_t east = facts.warp->place.first.col - facts.place.first.col - laid.place.first.col;
  const std::int32_t south = facts.warp->place.first.row - facts.place.first.row - laid.place.first.row;
  const GridRect there{{part.first.col + east, part.first.row + south}, {part.last.col + east, part.last.row + south}};
  const GridRect held = common(
      there,
      {{0, 0}, {static_cast<std::int32_t>(laid.place.cols()) - 1, static_cast<std::int32_t>(laid.place.rows()) - 1}});
  const auto cols = static_cast<std::size_t>(part.cols()), rows = static_cast<std::size_t>(part.rows());
  const Patch<T> patch{codes, cols, rows, stride};
  const Patch<std::uint8_t> valid{valid_at(), cols, rows, stride};
  for (std::size_t r = 0; r < rows; ++r) {
    std::fill_n(patch.row(r), cols, T{0});
    std::fill_n(valid.row(r), cols, std::uint8_t{0});
  }
  if (is_empty(held)) return;
  const auto left = static_cast<std::size_t>(held.first.col - there.first.col),
             above = static_cast<std::size_t>(held.first.row - there.first.row);
  const Patch<T> heights{patch.row(above) + left, static_cast<std::size_t>(held.cols()),
                         static_cast<std::size_t>(held.rows()), stride};
  const Patch<std::uint8_t> data{valid.row(above) + left, heights.cols, heights.rows, stride};
  read_band(set.warped.heights.get(), 1, held, set.laid.get(), facts.name, heights);
  read_band(set.warped.heights.get(), 2, held, set.laid.get(), facts.name, data);
  std::vector<std::int32_t> owners;
  if (set.warped.owners) {
    owners.resize(heights.cols * heights.rows);
    const Patch<std::int32_t> all{owners.data(), heights.cols, heights.rows, heights.cols};
    read_band(set.warped.owners.get(), 1, held, set.laid.get(), facts.name, all);
  }
  for (std::size_t r = 0, i = 0; r < heights.rows; ++r) {
    for (std::size_t c = 0; c < heights.cols; ++c, ++i) {
      const bool is_mine = owners.empty() || owners[i] == 0 || owners[i] == facts.warp->member + 1;
      const T height = heights.row(r)[c];
      const bool is_data = data.row(r)[c] != 0 && is_mine && height == height;
      data.row(r)[c] = static_cast<std::uint8_t>(is_data);
      if (!is_data) heights.row(r)[c] = T{0};
    }
  }
  code_heights(patch, valid, facts, coding,
               {part.first.col - facts.place.first.col, part.first.row - facts.place.first.row});
}

using ValidAt = std::function<std::uint8_t*()>;
template void ResampledRasters::read(const RasterFacts&, GridRect, const RasterCoding&, std::int16_t*, std::size_t,
                                     const ValidAt&);
template void ResampledRasters::read(const RasterFacts&, GridRect, const RasterCoding&, float*, std::size_t,
                                     const ValidAt&);
template void ResampledRasters::read(const RasterFacts&, GridRect, const RasterCoding&, double*, std::size_t,
                                     const ValidAt&);

}  // namespace talus
