#pragma once
// Reads resampled rasters as height codes.

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <unordered_map>

#include "ingest/mosaic/warp.hpp"
#include "ingest/raster/height_coding.hpp"

namespace talus {

/// The open datasets of resampled rasters: one for each set of LaidRasters.
class ResampledRasters {
 public:
  /// As RasterSource::read, for a raster with a warp. A sample that another member owns is void here.
  template <class T>
  void read(const RasterFacts& facts, GridRect part, const RasterCoding& coding, T* codes, std::size_t stride,
            const std::function<std::uint8_t*()>& valid);

 private:
  struct Open {
    DatasetOwner laid;  // the other datasets read from it
    WarpedBands warped;
  };
  Open& open(const LaidRasters& laid);
  std::unordered_map<const LaidRasters*, Open> open_;
};

}  // namespace talus
