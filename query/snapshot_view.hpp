#pragma once
// The contents of a Snapshot.

#include "query/pages/stored_pages.hpp"
#include "query/selection/range_query.hpp"

namespace talus {

struct Snapshot::View {
  StoredPages pages;
  int threads = 1;  ///< number of threads for a large question
};

[[nodiscard]] const StoredPages& pages_of(const Snapshot& snapshot);

}  // namespace talus
