#pragma once
// What lies between two tolerances.

#include "query/pages/stored_pages.hpp"

namespace talus {

/// See Snapshot::increment.
[[nodiscard]] Increment increment_query(const StoredPages& pages, GridRect region, Metres from, Metres to, int threads);

}  // namespace talus
