#pragma once
// Pages by name, found from the top down: only a page above tells one that is not stored from one that is missing.

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "query/stored_pages.hpp"

namespace talus {

/// For the questions of one thread.
class PageWalk {
 public:
  PageWalk(const StoredPages& pages, QueryCost& cost);

  /// What the page above (or the header) says of a page; none if it is not stored.
  [[nodiscard]] std::optional<ChildEntry> entry(PageId id);
  /// Null: not stored, no vertex there is needed by any triangle.
  /// fails  corrupt: a page on the way
  [[nodiscard]] std::shared_ptr<const Page> find(PageId id);
  /// The page with a vertex's own height and error.
  [[nodiscard]] std::shared_ptr<const Page> find(GridPoint p) {
    return find(page_of(p, band_of(p, pages_.manifest().bands)));
  }

 private:
  struct Last {
    PageId id;
    std::shared_ptr<const Page> page;
  };
  using Below = std::vector<ChildEntry>;
  const Below* below(PageId id);

  const StoredPages& pages_;
  QueryCost& cost_;
  std::vector<PageId> tops_;
  std::vector<Last> last_;  ///< by band
  std::vector<std::unordered_map<std::uint64_t, Below>> known_;  ///< by band: tables of pages below
};

}  // namespace talus
