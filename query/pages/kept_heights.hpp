#pragma once
// Heights of a database that kept only the vertices of its finest tolerance.

#include <unordered_map>
#include <vector>

#include "query/pages/stored_pages.hpp"

namespace talus {

/// Where heights were dropped: a vertex that the finest answer does not need lies on its surface, halfway between
/// the ends of the side or diagonal it stands on. A border may need one; it then changes no surface.
///
/// Why that keeps the promise: with a vertex, all that depend on it were dropped, so below a triangle whose corners
/// were kept and whose midpoint was not, everything lies in that triangle's plane, and that is within the error of the
/// midpoint of every sample. Such a triangle there is above every triangle of an answer, because whatever has a
/// triangle that leaves the extent was kept (is_near_border).
class KeptHeights {
 public:
  KeptHeights(const StoredPages& pages, QueryCost& cost) : pages_(pages), cost_(cost) {}

  /// Whether sample i of a page, a vertex of its band at p, stands at its own height. A page may hold more heights.
  [[nodiscard]] bool is_kept(const Page& page, std::size_t i, GridPoint p) const {
    return all_kept_ || page.error(i, pages_.distance()) > largest_dropped_ || is_near_border(p, page.extent);
  }
  /// In height codes; 0 where nothing needs a height and none is stored.
  /// fails  corrupt: a page
  [[nodiscard]] double at(GridPoint p);

 private:
  struct Band {
    PageDecoder decoder;
    PageId id;
    const Page* page = nullptr;
  };
  [[nodiscard]] const Page* page_with(GridPoint p);

  const StoredPages& pages_;
  QueryCost& cost_;
  bool all_kept_ = pages_.manifest().description.kept_above() == 0;
  ErrorCode largest_dropped_ = largest_code_within(pages_.manifest().description.kept_above());
  /// The page last used of each.
  std::vector<Band> bands_ = std::vector<Band>(static_cast<std::size_t>(pages_.manifest().bands));
  std::unordered_map<std::uint64_t, double> found_;
};

}  // namespace talus
