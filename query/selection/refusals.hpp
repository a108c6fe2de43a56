#pragma once
// Questions that make no sense are refused in one place.

#include "query/pages/stored_pages.hpp"
#include "talus/question.hpp"

namespace talus {

// All fail with invalid_argument.
void require_inside(const StoredPages& pages, GridRect region);
void require_tolerance(Metres tolerance);
void require_sense(const StoredPages& pages, const Question& question);

}  // namespace talus
