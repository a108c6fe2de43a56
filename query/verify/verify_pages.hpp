#pragma once
// Verify, first part: compares pages with the pages above, below and beside them.

#include <cstdint>
#include <functional>
#include <unordered_map>

#include "query/pages/decoded_pages.hpp"
#include "query/verify/verify_findings.hpp"

namespace talus {

/// The result of checking a page.
struct CheckedPage {
  ChildEntry entry;  ///< as the page above should have it; for band 1, the tile's record, too
  /// Of a dense page: the largest errors in eighths, of those that follow from heights and of those that are stored.
  std::int32_t largest_implied = -1, largest_stored = -1;
  bool is_readable = true;
};
using CheckedPages = std::unordered_map<std::uint64_t, CheckedPage>;  ///< by curve position

/// Checks all pages, the finest band first: the entries of pages below, the heights and voids that the page above
/// repeats, and each error against those of the vertices that depend on it, in whatever page.
///
/// told     called after each page
/// returns  the pages of band 1
/// cost     memory: 100 bytes a page of the finest band
[[nodiscard]] CheckedPages check_pages(const StoredPages& pages, DecodedPages& decoded, Findings& findings,
                                       VerifyReport& report, const std::function<void()>& told);

}  // namespace talus
