// Danger: one sample stands out of a plain. Whoever looks at means, at overviews or at every second sample does not
// see it, least of all where tiles, pages and blocks meet.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kHeight = 50;
constexpr int kRow = 65;

/// What is left of the spike in an overview that averages squares of so many samples a side.
double naive_error(const Terrain& terrain, int side) {
  double largest = 0;
  for (int north = 0; north + side <= terrain.rows; north += side) {
    for (int west = 0; west + side <= terrain.cols; west += side) {
      double sum = 0;
      for (int row = north; row < north + side; ++row) {
        for (int col = west; col < west + side; ++col) sum += terrain.at(col, row);
      }
      largest = std::max(largest, std::abs(sum / (side * side) - 100));
    }
  }
  return largest;
}

TEST(OneSpike, IsNothingInAMean) {
  const Terrain terrain = spike(1100, 140, 1023, kRow, kHeight);
  EXPECT_EQ(naive_error(terrain, 1), kHeight);
  EXPECT_LT(naive_error(terrain, 64), 0.02);
}

TEST(OneSpike, AtEveryKindOfBorderIsFoundAtItsHeight) {
  for (const int col : {63, 64, 65, 127, 128, 129, 1023, 1024, 1025}) {
    SCOPED_TRACE(col);
    const HardDatabase database({.terrain = spike(1100, 140, col, kRow, kHeight)});
    EXPECT_TRUE(has_point(database.judged(kHeight - 1), {col, kRow}));
    EXPECT_EQ(database.judged(kHeight).points.size(), database.judged(1e9).points.size());
  }
}

TEST(OneSpike, KeepsThePromise) {
  HardCase hard{.terrain = spike(1100, 140, 1024, kRow, kHeight)};
  hard.tolerances = {49, 50, 51};
  HardDatabase(hard).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
