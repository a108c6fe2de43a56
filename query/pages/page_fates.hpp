#pragma once
// Counts which pages of a region are read, and why others are not.

#include "query/pages/stored_pages.hpp"

namespace talus {

/// Fills BandCost. When a page is read, its child pages count as left out. When a child page is read later, it moves to
/// the pages that were read. So a caller need not say why it leaves out a page.
class PageFates {
 public:
  /// finest_height  log2 of the smallest spacing in the answer
  PageFates(const StoredPages& pages, GridRect region, QueryCost& cost, int finest_height = 0);

  /// Counts the region's pages, and the pages of the coarsest band. If several threads count, only one calls this.
  void begin();

  /// Moves a page from those that are left out to those that a slice replaced.
  void replace(PageId id) { --left_out(id), ++band(id).from_slice; }

  /// Counts a page that is read for the first time. is_wanted: false if only the border or a point needs it.
  void look_into(const Page& page, bool is_wanted);

 private:
  [[nodiscard]] BandCost& band(PageId id) { return cost_.bands[static_cast<std::size_t>(id.band)]; }
  /// The count for a stored page that was not read.
  [[nodiscard]] std::uint64_t& left_out(PageId id);

  const Manifest& manifest_;
  GridRect region_;
  QueryCost& cost_;
  int finest_height_;
};

}  // namespace talus
