#pragma once
// Verify: compares the slices of tiles with the pages that they were made from.

#include "query/pages/decoded_pages.hpp"
#include "query/verify/verify_findings.hpp"
#include "query/verify/verify_pages.hpp"

namespace talus {

/// Checks that each tile with a page of band 1 has a slice of that generation, that no other slice is stored, and that a
/// slice has exactly the vertices of its tile's pages whose errors are above its threshold or that the border of the
/// extent needs, with their heights, errors and covers.
void check_slices(const StoredPages& pages, DecodedPages& decoded, const CheckedPages& of_band_1, Findings& findings);

}  // namespace talus
