#pragma once
// What stands behind a Snapshot.

#include "query/range_query.hpp"
#include "query/stored_pages.hpp"

namespace talus {

struct Snapshot::View {
  StoredPages pages;
  int threads = 1;  ///< for a large question
};

[[nodiscard]] const StoredPages& pages_of(const Snapshot& snapshot);

}  // namespace talus
