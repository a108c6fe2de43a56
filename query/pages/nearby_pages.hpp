#pragma once
// Finds pages near each other, from the coarsest page down.

#include <array>
#include <memory>
#include <vector>

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"

namespace talus {

/// Finds pages for a walk over the map. It keeps four pages of each band, one for each parity of column and row, so
/// that the pages around a corner where four pages meet are looked up once.
class NearbyPages {
 public:
  NearbyPages(const StoredPages& pages, QueryCost& cost, const Watch& watch = unwatched())
      : pages_(pages), cost_(cost), watch_(watch) {}

  /// The page's child entry, read from its parent page. `present` is false if the page has only voids or is outside.
  [[nodiscard]] const ChildEntry& entry(PageId id) { return place(id).entry; }
  /// The page, valid until another page of its band and parity is looked up; null if it is not stored.
  /// fails  corrupt
  [[nodiscard]] const Page* page(PageId id);
  /// The page that has a vertex as an own vertex.
  [[nodiscard]] const Page* page_of_vertex(GridPoint p);

 private:
  struct Place {
    PageId id{-1, 0, 0};
    ChildEntry entry;
    std::shared_ptr<const Page> page;  ///< null until page() reads it
  };
  [[nodiscard]] Place& place(PageId id);
  [[nodiscard]] const Page* page_at(Place& place);
  [[nodiscard]] ChildEntry look_up(PageId id);

  const StoredPages& pages_;
  QueryCost& cost_;
  const Watch& watch_;  ///< checked before a page is read
  using Places = std::vector<std::array<Place, 4>>;
  std::vector<PageId> tops_ = pages_of_band(pages_.manifest().bands - 1, pages_.manifest().description.extent);
  Places bands_ = Places(static_cast<std::size_t>(pages_.manifest().bands));
};

}  // namespace talus
