#pragma once
// Pages around a place, found from the pages above them.

#include <array>
#include <memory>
#include <vector>

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"

namespace talus {

/// Walks down to pages as a walk over the map needs them. Of each band four pages stay at hand, one of each parity of
/// column and row: what lies around a corner where four pages meet is looked up once.
class NearbyPages {
 public:
  NearbyPages(const StoredPages& pages, QueryCost& cost, const Watch& watch = unwatched())
      : pages_(pages), cost_(cost), watch_(watch) {}

  /// What is known of a page without reading it; present is false for one that holds voids only, or lies elsewhere.
  [[nodiscard]] const ChildEntry& entry(PageId id) { return place(id).entry; }
  /// Until four other pages were asked for; null if it is not stored.
  /// fails  corrupt
  [[nodiscard]] const Page* page(PageId id);
  /// The page where a vertex stands with its own height and error.
  [[nodiscard]] const Page* page_of_vertex(GridPoint p);

 private:
  struct Place {
    PageId id{-1, 0, 0};
    ChildEntry entry;
    std::shared_ptr<const Page> page;  ///< once it was asked for
  };
  [[nodiscard]] Place& place(PageId id);
  [[nodiscard]] const Page* page_at(Place& place);
  [[nodiscard]] ChildEntry look_up(PageId id);

  const StoredPages& pages_;
  QueryCost& cost_;
  const Watch& watch_;  ///< looked at before a page is read
  using Places = std::vector<std::array<Place, 4>>;
  std::vector<PageId> tops_ = pages_of_band(pages_.manifest().bands - 1, pages_.manifest().description.extent);
  Places bands_ = Places(static_cast<std::size_t>(pages_.manifest().bands));
};

}  // namespace talus
