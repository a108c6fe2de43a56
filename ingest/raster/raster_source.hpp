#pragma once
// Reads one raster as height codes.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <type_traits>
#include <vector>

#include "ingest/raster/height_coding.hpp"
#include "ingest/raster/raster_facts.hpp"

namespace talus {

template <class T>
inline constexpr GDALDataType kGdalType = std::is_same_v<T, std::uint8_t>   ? GDT_Byte
                                          : std::is_same_v<T, std::int16_t> ? GDT_Int16
                                          : std::is_same_v<T, std::int32_t> ? GDT_Int32
                                          : std::is_same_v<T, float>        ? GDT_Float32
                                                                            : GDT_Float64;

/// An open raster. A sample is void by nodata, mask, alpha or NaN; its code is 0 then. South-up and mirrored rasters
/// are reversed.
class RasterSource {
 public:
  /// Opens the file again.
  /// fails  io: the file has changed; unsupported
  explicit RasterSource(const RasterFacts& facts);

  /// Reads a rectangle of the grid of `facts.place` into `codes`, whose rows are `stride` apart.
  ///
  /// T        int16_t, float or double: holds every raw sample and every code
  /// valid    gives memory for the mask, one byte a sample, same stride; called only if some samples may be void
  /// returns  whether `valid` was called; if not, all samples are valid
  /// fails    io: names the rows; invalid_argument: a sample that is not a height
  /// cost     reads the rectangle once
  template <class T>
  bool read(GridRect part, const RasterCoding& coding, T* codes, std::size_t stride,
            const std::function<std::uint8_t*()>& valid) const;

 private:
  RasterFacts facts_;
  DatasetOwner dataset_;
  GDALRasterBandH band_ = nullptr;
  GDALRasterBandH mask_ = nullptr;         // null if there is none, or if nodata says it all
  GDALRasterBandH nodata_mask_ = nullptr;  // GDAL's mask of nodata, also for values written with other digits
  std::vector<GDALRasterBandH> alphas_;

  [[nodiscard]] GDALRasterBandH band(int number) const;
  template <class T>
  void read_samples(GridRect part, const Patch<T>& samples) const;
  template <class T>
  void read_band(GDALRasterBandH band, GridRect part, const Patch<T>& samples) const;
};

}  // namespace talus
