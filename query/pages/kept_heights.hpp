#pragma once
// Heights of a database that kept only the vertices of its finest tolerance.

#include <unordered_map>
#include <vector>

#include "engine/quadtree/border.hpp"
#include "query/pages/stored_pages.hpp"

namespace talus {

/// Computes dropped heights. A vertex that the finest answer does not need lies on its surface, halfway between the
/// ends of its side or diagonal. A border may need such a vertex; it then changes no surface.
///
/// Why every sample stays within the bound: when a vertex was dropped, all its descendants were dropped, too. Take a
/// triangle with three kept corners and a dropped midpoint. All its vertices lie in its plane, and every sample lies
/// within the midpoint's error of this plane. A triangle of an answer with a dropped corner always lies in such a
/// triangle, because vertices with a triangle that leaves the extent were kept (is_near_border). Those are closed under
/// parents, like the vertices above a tolerance.
class KeptHeights {
 public:
  KeptHeights(const StoredPages& pages, QueryCost& cost) : pages_(pages), cost_(cost) {}

  [[nodiscard]] bool all_are_kept() const { return all_kept_; }
  /// Whether the height of sample i at p, an own vertex, was kept. A page that is in no slice has more heights than those.
  [[nodiscard]] bool is_kept(const Page& page, std::size_t i, GridPoint p) const {
    return all_kept_ || page.error(i, pages_.distance()) > largest_dropped_ ||
           is_near_border(p, pages_.manifest().description.extent);
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

  const StoredPages& pages_;
  QueryCost& cost_;
  bool all_kept_ = pages_.manifest().description.kept_above().value == 0;
  ErrorCode largest_dropped_ = largest_code_within(pages_.manifest().description.kept_above().value);
  std::vector<Band> bands_;  ///< the page of each band that was used last; empty until one is
  std::unordered_map<std::uint64_t, double> found_;
};

}  // namespace talus
