// Danger: files whose first row is the southernmost, or whose first column is the easternmost. Whoever takes the first
// sample for the north-western has every height at the wrong place, though all of them are there.

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

Terrain ground() {
  Terrain terrain = hills(200, 1100);
  terrain.at(130, 1024) = 5000;
  terrain.at(64, 1) = -5000;
  return hole(terrain, 0, 1000, 20, 1099);
}

/// Where a sample of row `row` in the file stands, if the first row were the northernmost.
int naive_row(int row) { return row; }

void expect_promise(double dx, double dy) {
  HardCase hard{.terrain = ground()};
  hard.file.geotransform = {700000, dx, 0, 5000000, 0, dy};
  hard.judging = {.cell_width_m = 10, .cell_height_m = 10};
  const HardDatabase database(hard);
  database.hold_to_the_promise();
  const GridMapping m = database.now().description().mapping;
  EXPECT_EQ(m.dx, 10);
  EXPECT_EQ(m.dy, -10);
  EXPECT_TRUE(has_point(database.judged(4000), {130, 1024}));
}

TEST(SouthUpAndMirrored, PutHeightsAtOtherPlaces) {
  const int row_in_file = 1099 - 1024;
  EXPECT_NE(naive_row(row_in_file), 1024);
}

TEST(SouthUpAndMirrored, KeepThePromise) {
  expect_promise(10, -10);
  expect_promise(10, 10);
  expect_promise(-10, 10);
}

}  // namespace
}  // namespace talus::support
