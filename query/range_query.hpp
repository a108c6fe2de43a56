#pragma once
// A rectangle and a tolerance become a restricted quadtree.

#include "query/stored_pages.hpp"

namespace talus {

/// See Snapshot::range.
[[nodiscard]] Answer range_query(const StoredPages& pages, GridRect region, Metres tolerance);

/// The samples of a region from the finest pages. See Snapshot::samples.
[[nodiscard]] SampleWindow stored_samples(const StoredPages& pages, GridRect region);

}  // namespace talus
