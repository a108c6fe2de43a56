#pragma once
// Questions that a tolerance and a constrained border alone do not answer: which vertices first, then their heights.

#include <span>
#include <vector>

#include "query/pages/stored_pages.hpp"
#include "talus/database.hpp"

namespace talus {

/// See Snapshot::ask. Looks at pages twice where range_query does once.
[[nodiscard]] Answer select_and_gather(const StoredPages& pages, const Question& question);

/// See Snapshot::ask_together.
[[nodiscard]] std::vector<Answer> select_and_gather(const StoredPages& pages, std::span<const Question> patches);

}  // namespace talus
