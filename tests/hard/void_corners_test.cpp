// Danger: voids at the corners of blocks only, every 64th sample, and all else data on a slope. A fill that is chosen
// after the errors were computed, here the mean of the raster, moves the surface beneath samples already measured.

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

double height(int col, int row) { return 8 * col + row; }

Terrain ground(int cols, int rows) {
  Terrain terrain = surface(cols, rows, height);
  for (int row = 0; row < rows; row += 64) {
    for (int col = 0; col < cols; col += 64) terrain.make_void(col, row);
  }
  return terrain;
}

/// How far the surface moves at a corner when its fill does.
double naive_error(int cols, int rows, int col, int row) {
  return std::abs(height(cols / 2, rows / 2) - height(col, row));
}

TEST(VoidCorners, MoveWithALaterFill) { EXPECT_GT(naive_error(1100, 200, 1024, 64), 3000); }

TEST(VoidCorners, KeepThePromise) {
  for (const auto& [cols, rows] : {std::pair(1100, 200), std::pair(129, 1026)}) {
    HardCase hard{.terrain = ground(cols, rows)};
    hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
    hard.tolerances = {1, 3, 8, 12, 64, 100, 1500};
    hard.regions = {{{0, 0}, {64, 64}}, {{64, 64}, {128, 128}}};
    HardDatabase(hard).hold_to_the_promise();
  }
}

TEST(VoidCorners, KeepThePromiseWithoutWeight) {
  HardCase hard{.terrain = ground(300, 200)};
  hard.void_weight = 0;
  hard.tolerances = {1, 8, 100, 1500};
  HardDatabase(hard).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
