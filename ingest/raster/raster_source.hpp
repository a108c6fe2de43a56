#pragma once
// One open raster, read as height codes.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "ingest/raster/height_coding.hpp"
#include "ingest/raster/raster_facts.hpp"

namespace talus {

/// A sample is void by nodata, mask, alpha or NaN, and has the code 0 then. South-up and mirrored rasters are turned.
class RasterSource {
 public:
  /// Opens the file again.
  /// fails  io: it is no longer what it was; unsupported
  explicit RasterSource(const RasterFacts& facts);

  /// Reads samples of the grid that `facts.place` lies on into `codes`, whose rows are `stride` apart.
  ///
  /// T       int16_t, float or double, one that holds every raw sample and every code
  /// valid   says where which samples are data goes, one byte each, rows as far apart; asked only if some may be void
  /// returns whether it was asked; if not, all are data
  /// fails   io: names the rows; invalid_argument: a sample that is no height
  /// cost    one read of the file
  template <class T>
  bool read(GridRect part, const RasterCoding& coding, T* codes, std::size_t stride,
            const std::function<std::uint8_t*()>& valid) const;

 private:
  RasterFacts facts_;
  DatasetOwner dataset_;
  GDALRasterBandH band_ = nullptr;
  GDALRasterBandH mask_ = nullptr;         // null where there is none, or nodata says it all
  GDALRasterBandH nodata_mask_ = nullptr;  // what GDAL makes of nodata: cells written with other digits, too
  std::vector<GDALRasterBandH> alphas_;

  [[nodiscard]] GDALRasterBandH band(int number) const;
  template <class T>
  void read_samples(GridRect part, const Patch<T>& samples) const;
  template <class T>
  void read_band(GDALRasterBandH band, GridRect part, const Patch<T>& samples) const;
};

}  // namespace talus
