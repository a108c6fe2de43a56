// Danger: a ring of voids around an island. The corners and the midpoint of a large triangle are all data while the
// ring runs through it; whoever asks only these calls it whole and covers the ring.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr int kSide = 180;

bool is_ring(int col, int row) {
  const double r = std::hypot(col - 88, row - 88);
  return r > 18 && r < 21;
}

Terrain ground(int west) {
  Terrain terrain = hills(west + kSide, kSide);
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      if (is_ring(col, row)) terrain.make_void(west + col, row);
    }
  }
  return terrain;
}

/// Is the triangle (64, 64), (128, 64), (64, 128) taken for data?
bool naive_is_whole(const Terrain& t) {
  return t.is_valid(64, 64) && t.is_valid(128, 64) && t.is_valid(64, 128) && t.is_valid(96, 96);
}

TEST(VoidRing, RunsThroughATriangleThatLooksWhole) {
  const Terrain terrain = ground(0);
  EXPECT_TRUE(naive_is_whole(terrain));
  EXPECT_FALSE(terrain.is_valid(76, 72)) << "inside it";
}

TEST(VoidRing, KeepsThePromise) {
  for (const int west : {0, 1024 - 88}) {  // the second with its middle on the border of a tile
    HardCase hard{.terrain = ground(west)};
    hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
    hard.tolerances = {1, 2, 4, 20, 100};
    hard.regions = {{{west + 64, 64}, {west + 112, 112}}};
    HardDatabase(hard).hold_to_the_promise();
  }
}

}  // namespace
}  // namespace talus::support
