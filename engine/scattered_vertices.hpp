#pragma once
// A few vertices anywhere on the grid, for walks along the dependency graph from the finest level to the coarsest.

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "engine/grid.hpp"

namespace talus {

/// Vertices by level, the side midpoints and the centres of each apart. A side midpoint's parents are centres of its
/// own level, a centre's are of coarser ones. So a walk over the side midpoints of a level, then its centres, then the
/// next coarser level may insert the parents of what it visits: they always come later.
class ScatteredVertices {
 public:
  /// The same vertex may come many times.
  void insert(GridPoint p) { list(height_in_tree(p), is_centre(p)).push_back(p); }

  /// Row by row, none twice. Valid until one of them is inserted again.
  [[nodiscard]] const std::vector<GridPoint>& of_level(int shift, bool centres) {
    std::vector<GridPoint>& found = list(shift, centres);
    std::sort(found.begin(), found.end(),
              [](GridPoint a, GridPoint b) { return a.row != b.row ? a.row < b.row : a.col < b.col; });
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  template <class Visit>
  void for_each(Visit&& visit) {
    for (int shift = 0; shift < kLevels; ++shift) {
      for (const bool centres : {false, true}) {
        for (const GridPoint p : of_level(shift, centres)) visit(p);
      }
    }
  }

 private:
  static constexpr int kLevels = std::countr_zero(static_cast<std::uint32_t>(kRootSpacing)) + 1;
  [[nodiscard]] std::vector<GridPoint>& list(int shift, bool centres) {
    return lists_[2 * static_cast<std::size_t>(shift) + (centres ? 1 : 0)];
  }
  std::array<std::vector<GridPoint>, 2 * kLevels> lists_;
};

}  // namespace talus
