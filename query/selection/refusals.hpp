#pragma once
// Questions that make no sense are refused in one place.

#include "query/pages/stored_pages.hpp"
#include "talus/question.hpp"

namespace talus {

// All fail with invalid_argument.

void require_inside(const StoredPages& pages, GridRect region);
void require_tolerance(Metres tolerance);
/// An increment goes from a tolerance to a smaller one.
void require_finer(Metres from, Metres to);

/// A question with its region in samples, all its points there, and nothing in it that has no answer: the one door that
/// every question goes through. Of the budget and of heights' quanta only what needs no search and no rounding.
///
/// together  it is one of several, see Snapshot::ask_together
[[nodiscard]] Question accepted(const StoredPages& pages, const Question& question, bool together);

}  // namespace talus
