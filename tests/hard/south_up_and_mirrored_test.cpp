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

/// The height at a sample, found where it would be if the first row of the file were the northernmost.
double naive_height(const Terrain& file, int col, int row) { return file.at(col, row); }

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
  const Terrain terrain = ground();
  const Terrain file = surface(200, 1100, [&](int col, int row) { return terrain.at(col, 1099 - row); });
  EXPECT_EQ(terrain.at(130, 1024), 5000);
  EXPECT_LT(naive_height(file, 130, 1024), 1000) << "the peak is 949 rows further north";
}

TEST(SouthUpAndMirrored, KeepThePromise) {
  expect_promise(10, -10);
  expect_promise(10, 10);
  expect_promise(-10, 10);
}

}  // namespace
}  // namespace talus::support
