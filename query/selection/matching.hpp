#pragma once
// Sides that two regions share, and the vertices on them. [P98 §9]

#include <vector>

#include "engine/quadtree/grid.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// The sides that two regions share: rectangles one sample wide or high, and at least one cell long.
[[nodiscard]] std::vector<GridRect> shared_sides(GridRect a, GridRect b);

/// Visits the vertices of region `of` on the sides that it shares with the other region.
template <class Visit>
void for_each_on_shared_sides(const VertexMask& vertices, GridRect of, GridRect other, Visit&& visit) {
  for (const GridRect& side : shared_sides(of, other)) {
    for (std::int32_t row = side.first.row; row <= side.last.row; ++row) {
      for (std::int32_t col = side.first.col; col <= side.last.col; ++col) {
        if (vertices.contains({col, row})) visit(GridPoint{col, row});
      }
    }
  }
}

}  // namespace talus
