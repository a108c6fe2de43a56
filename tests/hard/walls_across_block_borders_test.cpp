// Danger: thin walls that cross the borders of blocks, pages and tiles and stand on none of their corners. Whoever
// takes errors of coarse vertices from an overview, every 64th sample, has never seen them.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kHeight = 500;

bool is_wall(int col, int row) {
  return std::abs(3 * col - 29 * row - 100) < 4 || std::abs(17 * col - row - 17376) < 9;
}

HardCase hard_case() {
  HardCase hard{.terrain = surface(1100, 200, [](int col, int row) { return is_wall(col, row) ? kHeight : 0; })};
  hard.tolerances = {100, 250, 499, 500};
  hard.regions = {{{1000, 10}, {1050, 199}}};
  return hard;
}

double naive_largest(const Terrain& terrain, int every) {
  double largest = 0;
  for (int row = 0; row < terrain.rows; row += every) {
    for (int col = 0; col < terrain.cols; col += every) largest = std::max(largest, terrain.at(col, row));
  }
  return largest;
}

TEST(WallsAcrossBlockBorders, AreNotInAnOverview) {
  const Terrain& terrain = hard_case().terrain;
  EXPECT_EQ(naive_largest(terrain, 64), 0);
  EXPECT_EQ(naive_largest(terrain, 1), kHeight);
}

TEST(WallsAcrossBlockBorders, KeepThePromise) { HardDatabase(hard_case()).hold_to_the_promise(); }

}  // namespace
}  // namespace talus::support
