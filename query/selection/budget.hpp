#pragma once
// The smallest tolerance whose answer fits a budget.

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"
#include "talus/question.hpp"

namespace talus {

/// The smallest tolerance on the ladder of stored errors (engine/error/error_ladder.hpp) whose answer with a
/// constrained border fits a budget, see Question::budget. Exact, and without trial: pages with the largest errors are
/// counted first, until no other can matter.
/// fails  invalid_argument: a budget that the border alone exceeds, naming what it needs
/// cost   pages with errors above the result, the border's pages
[[nodiscard]] Metres tolerance_for(const StoredPages& pages, GridRect region, const Budget& budget, QueryCost& cost,
                                   Watch& watch = unwatched());

}  // namespace talus
