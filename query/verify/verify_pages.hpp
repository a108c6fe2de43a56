#pragma once
// Verify, first part: pages against themselves, the pages above them and beside them.

#include <cstdint>
#include <functional>
#include <unordered_map>

#include "query/pages/decoded_pages.hpp"
#include "query/verify/verify_findings.hpp"

namespace talus {

/// What is known of a page that was checked.
struct CheckedPage {
  ChildEntry entry;  ///< what the page above should say of it, and the record of a tile of its page of band 1
  bool is_readable = true;
};
using CheckedPages = std::unordered_map<std::uint64_t, CheckedPage>;  ///< by position

/// All pages, the finest band first. Each is held against its table of pages below it, against the heights and voids
/// that the page above repeats, and its errors against those of the vertices that they depend on, in whatever page
/// these are.
///
/// told    after each page
/// returns pages of band 1
/// cost    memory: 100 bytes a page of the finest band
[[nodiscard]] CheckedPages check_pages(const StoredPages& pages, DecodedPages& decoded, Findings& findings,
                                       VerifyReport& report, const std::function<void()>& told);

}  // namespace talus
