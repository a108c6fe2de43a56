#pragma once
// A rectangle and a tolerance become a restricted quadtree.

#include "query/stored_pages.hpp"

namespace talus {

/// See Snapshot::range. Threads change nothing in the answer.
[[nodiscard]] Answer range_query(const StoredPages& pages, GridRect region, Metres tolerance, int threads = 1);

struct StoredSamples {
  SampleWindow window;
  std::vector<std::uint8_t> dropped;  ///< 1 where a height was not kept and the value says nothing; empty: nowhere
};
/// The samples of a region from the finest pages.
[[nodiscard]] StoredSamples stored_samples(const StoredPages& pages, GridRect region);

}  // namespace talus
