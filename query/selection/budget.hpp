#pragma once
// The smallest tolerance whose answer fits a budget.

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"
#include "talus/question.hpp"

namespace talus {

/// The smallest tolerance on the ladder of stored errors (engine/error/error_ladder.hpp) whose answer with a
/// constrained border fits a budget, see Question::budget. The result is exact: the search counts pages with the
/// largest errors first, and needs no trial answers.
/// fails  invalid_argument: the border alone exceeds the budget; the message says what it needs
/// cost   reads the pages with errors above the result, and the border's pages
[[nodiscard]] Metres tolerance_for(const StoredPages& pages, GridRect region, const Budget& budget, QueryCost& cost,
                                   Watch& watch = unwatched());

}  // namespace talus
