// Danger: a bowl so wide that it is nearly flat in each tile. A large triangle over many tiles is off by far more than
// any small one; whoever carries up the largest error of the tiles below underestimates it.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr int kCols = 4200, kRows = 40;

double height(int col, int) { return std::floor((col - 2100.0) * (col - 2100) / 1000); }

double midpoint_error(int col, int s) {
  return std::abs(height(col, 0) - (height(col - s, 0) + height(col + s, 0)) / 2);
}

/// What the tiles of 1024 cells know of themselves: their own midpoints.
double naive_error() {
  double largest = 0;
  for (int col = 512; col + 512 < kCols; col += 1024) largest = std::max(largest, midpoint_error(col, 512));
  return largest;
}

TEST(BowlOverManyTiles, IsNearlyFlatInEach) {
  EXPECT_LT(naive_error(), 270);
  EXPECT_GT(midpoint_error(2048, 2048), 4000);
}

TEST(BowlOverManyTiles, KeepsThePromise) {
  for (const bool across : {true, false}) {
    HardCase hard{.terrain = across ? surface(kCols, kRows, height)
                                    : surface(kRows, kCols, [](int col, int row) { return height(row, col); })};
    hard.tolerances = {1, 270, 1048, 1050, 4000, 4200};
    HardDatabase(hard).hold_to_the_promise();
  }
}

}  // namespace
}  // namespace talus::support
