#pragma once
// Answers questions that need more than a tolerance and a constrained border: first the vertices, then their heights.

#include <deque>
#include <span>
#include <vector>

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"
#include "talus/database.hpp"

namespace talus {

/// Answers one accepted question or more, see Snapshot::ask_together. It reads pages twice, range_query once.
///
/// watches  one for each question
[[nodiscard]] std::vector<Answer> select_and_gather(const StoredPages& pages, std::span<const Question> patches,
                                                    std::deque<Watch>& watches);

}  // namespace talus
