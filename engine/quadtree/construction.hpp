#pragma once
// From a set of wanted vertices to the smallest restricted quadtree that holds it, for selections that are not closed
// as a threshold on saturated errors is. [P98 §4, algorithms 1 and 2]
//
// Both algorithms return the same: the closure over the whole grid (wanted vertices and all ancestors), cut at the
// region. Ancestors outside the region count, but are not returned, as in border_vertices. So a larger region with the
// same wanted vertices has the same members inside this one. A vertex of spacing `root` or more has no parents.

#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include "engine/quadtree/grid.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Bottom-up, in place: one sweep from the finest level to the coarsest, in which each member marks its parents. Call
/// seal() afterwards.
///
/// root     side of the root square, a power of two
/// returns  number of vertices added
/// cost     linear in the region's samples (64 at once) and in its sides
/// source   [P98 §4, algorithm 2]; 64 at once: ours
std::size_t close_bottom_up(VertexMask& vertices, std::int32_t root);

namespace detail {

/// The set that algorithm 1 grows. It remembers vertices outside the region, so that each is resolved once.
class ResolvedSet {
 public:
  ResolvedSet(GridRect region, std::int32_t root) : inside_(region), root_(root) {}
  /// Inserts a vertex and, if it is new, all its ancestors.
  void insert(GridPoint p);
  [[nodiscard]] VertexMask take() { return std::move(inside_); }

 private:
  [[nodiscard]] bool is_new(GridPoint p);
  VertexMask inside_;
  std::unordered_set<std::uint64_t> beyond_;
  std::int32_t root_;
};

}  // namespace detail

/// Top-down: descends through the squares of the quadtree, inserts the wanted ones among the centre and the four side
/// midpoints of each, and the ancestors of each new vertex. Call seal() afterwards.
///
/// wanted(GridPoint)      whether a vertex of the region is wanted
/// any_wanted(GridPoint)  whether to descend into the square with this centre; its side is twice the centre's spacing.
///                        false only if no wanted vertex lies in it or on its sides, corners excluded
/// cost                   linear in the result, if any_wanted is true for few other squares, and in the empty mask
/// source                 [P98 §4, algorithm 1]
template <class Wanted, class AnyWanted>
[[nodiscard]] VertexMask close_top_down(GridRect region, std::int32_t root, Wanted&& wanted, AnyWanted&& any_wanted) {
  detail::ResolvedSet set(region, root);
  const auto consider = [&](GridPoint p) {
    if (region.contains(p) && wanted(p)) set.insert(p);
  };
  const auto descend = [&](auto&& self, GridPoint centre, std::int32_t s) -> void {
    const auto [col, row] = centre;
    if (col + s < region.first.col || col - s > region.last.col || row + s < region.first.row ||
        row - s > region.last.row || !any_wanted(centre)) {
      return;
    }
    consider(centre);
    for (const GridPoint side : children(centre).at) consider(side);
    if (s == 1) return;
    for (const GridPoint corner_ward : {GridPoint{col - s / 2, row - s / 2},
                                        {col + s / 2, row - s / 2},
                                        {col - s / 2, row + s / 2},
                                        {col + s / 2, row + s / 2}}) {
      self(self, corner_ward, s / 2);
    }
  };
  // The root squares that the region touches.
  const auto down = [&](std::int32_t v) { return v & -root; };
  for (std::int32_t row = down(region.first.row); row <= region.last.row; row += root) {
    for (std::int32_t col = down(region.first.col); col <= region.last.col; col += root) {
      consider({col, row});
      if (root > 1) descend(descend, {col + root / 2, row + root / 2}, root / 2);
    }
  }
  return set.take();
}

}  // namespace talus
