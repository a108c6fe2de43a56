// Danger: void lines one sample wide that run along diagonals. They cut cells through corners; whoever calls a cell
// data when three of its corners are, whichever they are, draws triangles over the line that the cut of the cell
// forbids.

#include <utility>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

Terrain ground(int cols, int rows) { return void_diagonals(hills(cols, rows), 64); }

/// Data, if any three corners of the cell are.
bool naive_holds_data(const Terrain& t, int col, int row) {
  return t.is_valid(col, row) + t.is_valid(col + 1, row) + t.is_valid(col, row + 1) + t.is_valid(col + 1, row + 1) >= 3;
}

/// By the rule: cells are cut along the diagonal that joins corners of even column + row.
bool holds_data(const Terrain& t, int col, int row) {
  const bool falls = (col + row) % 2 == 0;
  const bool cut = falls ? t.is_valid(col, row) && t.is_valid(col + 1, row + 1)
                         : t.is_valid(col + 1, row) && t.is_valid(col, row + 1);
  const bool apex = falls ? t.is_valid(col + 1, row) || t.is_valid(col, row + 1)
                          : t.is_valid(col, row) || t.is_valid(col + 1, row + 1);
  return cut && apex;
}

TEST(VoidDiagonalLines, AreCrossedByCellsOfThreeCorners) {
  const Terrain terrain = ground(200, 140);
  int wrong = 0;
  for (int row = 0; row < 139; ++row) {
    for (int col = 0; col < 199; ++col) {
      wrong += naive_holds_data(terrain, col, row) && !holds_data(terrain, col, row);
    }
  }
  EXPECT_GT(wrong, 100);
}

TEST(VoidDiagonalLines, KeepThePromise) {
  for (const auto& [cols, rows] : {std::pair(200, 140), std::pair(1100, 140)}) {
    HardCase hard{.terrain = ground(cols, rows)};
    hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
    hard.tolerances = {1, 2, 3, 16, 64};
    HardDatabase(hard).hold_to_the_promise();
  }
}

}  // namespace
}  // namespace talus::support
