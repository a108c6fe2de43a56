// Danger: cliffs that run along the borders of blocks, pages and tiles. A vertex on such a border has half of its
// diamond on either side; whoever looks at his own half only sees level ground and misses the cliff.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr int kCols = 2100, kRows = 140;

double height(int col, int row) {
  double sum = row >= 64 ? 90 : 0;
  for (const int border : {64, 128, 1024, 2048}) sum += col >= border ? 300 : 0;
  return sum;
}

/// The largest distance from the plane over (col, row ± s) and the apex s to one side, all samples of that half.
double naive_error(int col, int row, int s, int side) {
  const double north = height(col, row - s), south = height(col, row + s), middle = (north + south) / 2;
  const double apex = height(col + side * s, row);
  double largest = 0;
  for (int right = 0; right <= s; ++right) {
    for (int down = right - s; down <= s - right; ++down) {
      const double plane = middle + (apex - middle) * right / s + (south - north) / 2 * down / s;
      largest = std::max(largest, std::abs(height(col + side * right, row + down) - plane));
    }
  }
  return largest;
}

TEST(CliffsAlongBlockBorders, AreLevelGroundInsideABlock) {
  for (const int col : {64, 128, 1024, 2048}) {
    EXPECT_EQ(naive_error(col, 32, 16, +1), 0);
    EXPECT_GT(naive_error(col, 32, 16, -1), 200) << "what lies beyond the border of column " << col;
  }
}

TEST(CliffsAlongBlockBorders, KeepThePromise) {
  HardCase hard{.terrain = surface(kCols, kRows, height)};
  hard.tolerances = {89, 90, 200, 280, 299, 300};
  HardDatabase(hard).hold_to_the_promise();
}

TEST(CliffsAlongBlockBorders, KeepThePromiseOneCellAside) {
  for (const int aside : {-1, 1}) {
    HardCase hard{.terrain = surface(kCols, kRows, [&](int col, int row) { return height(col + aside, row + aside); })};
    HardDatabase(hard).hold_to_the_promise();
  }
}

}  // namespace
}  // namespace talus::support
