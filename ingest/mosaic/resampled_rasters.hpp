#pragma once
// Rasters that are resampled, read as height codes.

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <unordered_map>

#include "ingest/mosaic/warp.hpp"
#include "ingest/raster/height_coding.hpp"

namespace talus {

/// The open datasets behind rasters that are resampled: one a set that is laid together.
class ResampledRasters {
 public:
  /// As RasterSource::read, for a raster with a warp. A sample whose nearest cell is another member's is void here.
  template <class T>
  void read(const RasterFacts& facts, GridRect part, const RasterCoding& coding, T* codes, std::size_t stride,
            const std::function<std::uint8_t*()>& valid);

 private:
  struct Open {
    DatasetOwner laid;  // the others read from it
    WarpedBands warped;
  };
  Open& open(const LaidRasters& laid);
  std::unordered_map<const LaidRasters*, Open> open_;
};

}  // namespace talus
