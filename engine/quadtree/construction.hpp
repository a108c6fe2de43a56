#pragma once
// From any set of wanted vertices to the least restricted quadtree that holds it: both algorithms of the paper. They
// are for selections that a threshold on saturated errors does not close by itself. [P98 §4, algorithms 1 and 2]
//
// Both return the same: the closure of what is wanted in a region, cut by the region. The closure is formed on the
// whole grid, of the wanted vertices, their parents, the parents' parents and so on; so a vertex beyond the region is
// never returned, but what it depends on inside the region is, as with border_vertices. Within the region the result is
// then what a larger one, with the same wanted vertices, would have given, and each member's parents that lie in the
// region are members. Vertices whose spacing is at least `root` depend on nothing, and are taken like any other: if
// they are wanted or something depends on them.

#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include "engine/quadtree/grid.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Bottom-up, in place: adds to the set all that it depends on, by one sweep from the finest level to the coarsest in
/// which each member marks its parents. Not sealed afterwards.
///
/// root     side of the root square, a power of two
/// returns  how many vertices were added
/// cost     linear in the region's samples, 64 at once, and in its sides
/// source   [P98 §4, algorithm 2]; sixty-four vertices at once: design of ours
std::size_t close_bottom_up(VertexMask& vertices, std::int32_t root);

namespace detail {

/// The set that algorithm 1 grows; what lies beyond the region is remembered, so that no vertex is resolved twice.
class ResolvedSet {
 public:
  ResolvedSet(GridRect region, std::int32_t root) : inside_(region), root_(root) {}
  /// Inserts a vertex and, if it is new, all that it depends on.
  void insert(GridPoint p);
  [[nodiscard]] VertexMask take() { return std::move(inside_); }

 private:
  [[nodiscard]] bool is_new(GridPoint p);
  VertexMask inside_;
  std::unordered_set<std::uint64_t> beyond_;
  std::int32_t root_;
};

}  // namespace detail

/// Top-down: descends the quadtree of squares, inserts what is wanted of the centre and the four side midpoints of each
/// square, and follows the dependencies of each vertex that is new. Not sealed.
///
/// wanted(GridPoint)          of a vertex in the region
/// any_wanted(GridPoint)      of the square that has this centre, its spacing being half the side: false only if no
///                            wanted vertex lies in it or on its sides, its corners left out. It saves the descent
/// cost                       in proportion to the result, if any_wanted is true of few other squares, and the region's
///                            empty mask
/// source                     [P98 §4, algorithm 1]
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
