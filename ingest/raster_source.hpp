#pragma once
// A raster as Talus sees it: samples on a grid with row 0 in the north, voids as a mask.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "talus/description.hpp"
#include "talus/units.hpp"

namespace talus {

/// Samples of a rectangle as height codes of the raster's step, row by row from the north.
struct CodeWindow {
  GridRect region{{0, 0}, {-1, -1}};
  std::vector<double> codes;        ///< unspecified where void
  std::vector<std::uint8_t> valid;  ///< 1 where the sample is data

  [[nodiscard]] std::size_t index(GridPoint p) const {
    return static_cast<std::size_t>((std::int64_t{p.row} - region.first.row) * region.cols() +
                                    (std::int64_t{p.col} - region.first.col));
  }
};

/// The first band of one local raster file, opened read-only. One thread at a time.
///
/// Samples are pixel centres. South-up and mirrored rasters are turned, so that columns run east and
/// rows south. Void is what the file declares void (nodata, mask, alpha) and NaN. Integer samples are
/// their own codes, with the band's scale and offset as the step; floats are codes as they are, scale
/// and offset applied.
class RasterSource {
 public:
  /// fails  not_found; unsupported: see raster_guard.hpp, sample type, rotation, vertical unit;
  ///        invalid_argument: no band, size or cells that make no sense; io
  explicit RasterSource(const std::filesystem::path& file);
  ~RasterSource();
  RasterSource(RasterSource&&) noexcept;
  RasterSource& operator=(RasterSource&&) noexcept;

  /// Minimum, maximum and void_samples take a pass over the data: they are 0 here, ingest fills them.
  [[nodiscard]] const Description& description() const { return description_; }

  /// How many bands the file has; the first is the one that is read.
  [[nodiscard]] int bands() const;

  /// fails  invalid_argument: beyond the extent, or a sample that is no height; io
  /// cost   one read; 9 bytes a sample
  [[nodiscard]] CodeWindow read_codes(GridRect part) const;
  /// The same in the vertical unit.
  [[nodiscard]] SampleWindow read(GridRect part) const;

 private:
  struct Gdal;
  std::unique_ptr<Gdal> gdal_;
  Description description_;
};

}  // namespace talus
