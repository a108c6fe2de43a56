#pragma once
// The smallest tolerance whose answer fits a budget.

#include "query/pages/stored_pages.hpp"
#include "talus/question.hpp"

namespace talus {

/// See Snapshot::tolerance_for.
[[nodiscard]] Metres tolerance_for(const StoredPages& pages, GridRect region, const Budget& budget, QueryCost& cost);

}  // namespace talus
