#pragma once
// Checks questions, and refuses those that have no answer.

#include "query/pages/stored_pages.hpp"
#include "talus/question.hpp"

namespace talus {

// All fail with invalid_argument.

void require_inside(const StoredPages& pages, GridRect region);
void require_tolerance(Metres tolerance);
/// An increment must go from a tolerance to a smaller one.
void require_finer(Metres from, Metres to);

/// Checks a question, and returns it with its region and its points in samples. Every question passes through here.
/// The tolerance of a budget and the quantum of heights are checked later, because they need a search or rounding.
///
/// together  the question is one of several, see Snapshot::ask_together
[[nodiscard]] Question accepted(const StoredPages& pages, const Question& question, bool together);

}  // namespace talus
