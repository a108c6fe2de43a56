#pragma once
// Keeps a few of many rasters open.

#include <cstddef>
#include <list>
#include <unordered_map>
#include <utility>
#include <vector>

#include "ingest/raster/raster_source.hpp"

namespace talus {

/// Opens rasters on demand and closes the least recently used one. For rasters that are not resampled.
class OpenRasters {
 public:
  explicit OpenRasters(const std::vector<RasterFacts>& rasters, std::size_t most = 48)
      : rasters_(&rasters), most_(most) {}

  /// Valid until the next call.
  const RasterSource& get(std::size_t raster) {
    if (const auto found = where_.find(raster); found != where_.end()) {
      open_.splice(open_.begin(), open_, found->second);
      return open_.front().second;
    }
    if (open_.size() >= most_) {
      where_.erase(open_.back().first);
      open_.pop_back();
    }
    open_.emplace_front(raster, RasterSource{(*rasters_)[raster]});
    where_[raster] = open_.begin();
    return open_.front().second;
  }

 private:
  using Open = std::list<std::pair<std::size_t, RasterSource>>;
  const std::vector<RasterFacts>* rasters_;
  std::size_t most_;
  Open open_;  // the most recently used first
  std::unordered_map<std::size_t, Open::iterator> where_;
};

}  // namespace talus
