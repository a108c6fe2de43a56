#pragma once
// Verify: compares the slices of tiles with the pages that they were made from.

#include <functional>

#include "query/pages/decoded_pages.hpp"
#include "query/verify/verify_findings.hpp"
#include "query/verify/verify_pages.hpp"

namespace talus {

/// Checks that each tile with a page of band 1 has a slice of that generation, with exactly the vertices of its pages
/// whose errors are above the threshold, and their heights, errors and covers; and that no other slice is stored.
void check_slices(const StoredPages& pages, DecodedPages& decoded, const CheckedPages& of_band_1, Findings& findings);

}  // namespace talus
