// Danger: teeth whose midpoints hide their points. Over heights 0, 3, 2, 1, 0 no midpoint is more than 2 off the line
// between its ends; without them the second sample is 3 off.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

int height(int col, int row) { return (row / 40 % 2 == 0 ? 1 : 100) * ((4 - col % 4) % 4); }

/// The largest distance of any midpoint from its two ends, all levels over four cells.
double naive_error(const Terrain& t, int col, int row) {
  const auto off = [&](int at, int s) { return std::abs(t.at(at, row) - (t.at(at - s, row) + t.at(at + s, row)) / 2); };
  return std::max({off(col + 2, 2), off(col + 1, 1), off(col + 3, 1)});
}

HardCase hard_case() {
  HardCase hard{.terrain = surface(1100, 140, height)};
  hard.tolerances = {1, 2, 2.5, 3, 200, 250, 300};
  return hard;
}

TEST(SawTeeth, FoolMidpoints) {
  const Terrain& terrain = hard_case().terrain;
  for (const int col : {64, 1020, 1024}) {
    EXPECT_EQ(naive_error(terrain, col, 16), 2);
    EXPECT_EQ(terrain.at(col + 1, 16) - (terrain.at(col, 16) + terrain.at(col + 4, 16)) / 2, 3);
  }
}

TEST(SawTeeth, KeepThePromise) { HardDatabase(hard_case()).hold_to_the_promise(); }

}  // namespace
}  // namespace talus::support
