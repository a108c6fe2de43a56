#pragma once
// Heights of a database that kept only the vertices of its finest tolerance.

#include <unordered_map>
#include <vector>

#include "query/pages/stored_pages.hpp"

namespace talus {

/// Computes dropped heights. A vertex that the finest answer does not need lies on its surface, halfway between the
/// ends of its side or diagonal. A border may need such a vertex; it then changes no surface.
///
/// Why every sample stays within the bound: when a vertex was dropped, all its descendants were dropped, too. Take a
/// triangle with three kept corners and a dropped midpoint. All its vertices lie in its plane, and every sample lies
/// within the midpoint's error of this plane. A triangle of an answer with a dropped corner always lies in such a
/// triangle, because vertices with a triangle that leaves the extent were kept (is_near_border).
class KeptHeights {
 public:
  KeptHeights(const StoredPages& pages, QueryCost& cost);

  /// Whether the height of an own vertex was kept. A page may have more heights than those.
  [[nodiscard]] bool is_kept(const Page& page, std::int32_t col, std::int32_t row) const {
    return all_kept_ || is_kept_for_its_error(page, col, row);
  }
  /// The height in height codes; 0 if no page has the vertex, because no triangle needs its height.
  /// fails  corrupt: a damaged page
  [[nodiscard]] double at(GridPoint p);

 private:
  struct Band {
    PageDecoder decoder;
    PageId id;
    const Page* page = nullptr;
  };
  [[nodiscard]] const Page* page_with(GridPoint p);
  [[nodiscard]] bool is_kept_for_its_error(const Page& page, std::int32_t col, std::int32_t row) const;

  const StoredPages& pages_;
  QueryCost& cost_;
  bool all_kept_;
  ErrorCode largest_dropped_;
  std::vector<Band> bands_;  ///< the page of each band that was used last
  std::unordered_map<std::uint64_t, double> found_;
};

}  // namespace talus
