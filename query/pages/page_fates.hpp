#pragma once
// Counts what becomes of the pages of a region.

#include "query/pages/stored_pages.hpp"

namespace talus {

/// BandCost in the making. A page is counted as left out when the page above it is looked into, and taken from there
/// when it is looked into itself; so whoever walks need not say why it passed a page by.
class PageFates {
 public:
  /// finest_height  log2 of the smallest spacing that is asked for
  PageFates(const StoredPages& pages, GridRect region, QueryCost& cost, int finest_height = 0);

  /// Counts the region's pages, and those that none is above. Once: where several threads count, in one of their costs.
  void begin();

  /// A page is looked into, not for the second time. Not wanted: for the border or a point only.
  void look_into(const Page& page, bool is_wanted);

 private:
  [[nodiscard]] BandCost& band(PageId id) { return cost_.bands[static_cast<std::size_t>(id.band)]; }
  /// Where a stored page counts that was left out.
  [[nodiscard]] std::uint64_t& left_out(PageId id);

  const Manifest& manifest_;
  GridRect region_;
  QueryCost& cost_;
  int finest_height_;
};

}  // namespace talus
