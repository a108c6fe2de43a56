#include "query/selection/matching.hpp"

#include <algorithm>

namespace talus {

std::vector<GridRect> shared_sides(GridRect a, GridRect b) {
  std::vector<GridRect> sides;
  const std::int32_t west = std::max(a.first.col, b.first.col), east = std::min(a.last.col, b.last.col);
  const std::int32_t north = std::max(a.first.row, b.first.row), south = std::min(a.last.row, b.last.row);
  if (north < south) {
    if (a.last.col == b.first.col) sides.push_back({{a.last.col, north}, {a.last.col, south}});
    if (b.last.col == a.first.col) sides.push_back({{b.last.col, north}, {b.last.col, south}});
  }
  if (west < east) {
    if (a.last.row == b.first.row) sides.push_back({{west, a.last.row}, {east, a.last.row}});
    if (b.last.row == a.first.row) sides.push_back({{west, b.last.row}, {east, b.last.row}});
  }
  return sides;
}

}  // namespace talus
