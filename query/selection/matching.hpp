#pragma once
// The side that two regions share, and the vertices on it. [P98 §9]

#include <optional>

#include "engine/quadtree/rect.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// The side that two regions share: a rectangle one sample wide or high, and at least one cell long.
[[nodiscard]] constexpr std::optional<GridRect> shared_side(GridRect a, GridRect b) {
  const GridRect both = common(a, b);
  const bool beside = a.last.col == b.first.col || b.last.col == a.first.col;
  const bool above = a.last.row == b.first.row || b.last.row == a.first.row;
  if ((beside && both.rows() > 1) || (above && both.cols() > 1)) return both;
  return std::nullopt;
}

/// Visits the vertices of region `of` on the side that it shares with the other region.
template <class Visit>
void for_each_on_shared_side(const VertexMask& vertices, GridRect of, GridRect other, Visit&& visit) {
  const std::optional<GridRect> side = shared_side(of, other);
  if (!side) return;
  for_each_point(*side, [&](GridPoint p) {
    if (vertices.contains(p)) visit(p);
  });
}

}  // namespace talus
