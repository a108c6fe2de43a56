#pragma once
// One open raster, read as height codes.

#include <cstddef>
#include <cstdint>
#include <functional>

#include "ingest/raster_facts.hpp"

namespace talus {

/// How raw samples become height codes.
struct Coding {
  enum class Rule {
    raw,     ///< a code is the sample
    value,   ///< a code is the height: scale and offset applied
    rounded  ///< a code is the height in whole steps, the nearest
  };
  Rule rule = Rule::raw;
  HeightStep step;
};

/// Samples void by nodata, mask, alpha or NaN have the code 0. South-up and mirrored rasters are turned.
class RasterSource {
 public:
  /// Opens the file again, and what resamples it if it must be.
  /// fails  io: it is no longer what it was; unsupported
  explicit RasterSource(const RasterFacts& facts);

  /// Reads samples of the common grid into `codes`, whose rows are `stride` apart.
  ///
  /// T       int16_t, float or double, one that holds every raw sample and every code
  /// valid   says where which samples are data goes, one byte each, rows as far apart; asked only if some may be void
  /// returns whether it was asked; if not, all are data
  /// fails   io: names the rows; invalid_argument: a sample that is no height
  /// cost    one read of the file
  template <class T>
  bool read(GridRect part, const Coding& coding, T* codes, std::size_t stride,
            const std::function<std::uint8_t*()>& valid) const;

 private:
  RasterFacts facts_;
  DatasetOwner dataset_, warped_;  // the latter reads from the former
  GDALRasterBandH band_ = nullptr;
  GDALRasterBandH mask_ = nullptr;  // null where nodata says it all

  void read_raw(GDALRasterBandH band, GDALDataType as, GridRect part, void* samples, std::size_t row_bytes) const;
};

}  // namespace talus
