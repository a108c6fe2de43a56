#pragma once
// Questions that a tolerance and a constrained border alone do not answer: which vertices first, then their heights.

#include <deque>
#include <span>
#include <vector>

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"
#include "talus/database.hpp"

namespace talus {

/// Accepted questions, see Snapshot::ask_together; one may stand alone. Looks at pages twice where range_query does
/// once.
///
/// watches  one for each
[[nodiscard]] std::vector<Answer> select_and_gather(const StoredPages& pages, std::span<const Question> patches,
                                                    std::deque<Watch>& watches);

}  // namespace talus
