// Danger: one valid sample in a raster of voids. It is under no triangle; a mean of its neighbours divides by none of
// them, and a largest error over nothing is whatever it began with.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

[[gnu::no_sanitize("float-divide-by-zero")]] double naive_fill(const Terrain& terrain, int col, int row) {
  double sum = 0, count = 0;
  for (int r = row - 1; r <= row + 1; ++r) {
    for (int c = col - 1; c <= col + 1; ++c) {
      if (terrain.is_valid(c, r)) sum += terrain.at(c, r), ++count;
    }
  }
  return sum / count;
}

HardCase hard_case(int cols, int rows, int col, int row) {
  HardCase hard{.terrain = hole(plane(cols, rows, 417, 0, 0), 0, 0, cols, rows)};
  hard.terrain.valid[hard.terrain.index(col, row)] = 1;
  return hard;
}

TEST(OneValidSample, LeavesNothingToDivideBy) {
  const HardCase hard = hard_case(1100, 140, 1024, 64);
  EXPECT_TRUE(std::isnan(naive_fill(hard.terrain, 100, 100)));
}

TEST(OneValidSample, KeepsThePromise) {
  for (const GridPoint p : {GridPoint{1024, 64}, {1023, 63}, {0, 0}, {1099, 139}}) {
    const HardDatabase database(hard_case(1100, 140, p.col, p.row));
    database.hold_to_the_promise();
    EXPECT_TRUE(database.judged(0).triangles.empty());
    EXPECT_TRUE(database.judged(1e9).triangles.empty());
    EXPECT_EQ(database.now().description().minimum_height, 417);
  }
}

TEST(OneValidSample, AndTwoMoreOfItsCellKeepThePromise) {
  HardCase hard = hard_case(1100, 140, 1024, 64);
  for (const int col : {1024, 1025}) hard.terrain.valid[hard.terrain.index(col, 65)] = 1;
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  const HardDatabase database(hard);
  database.hold_to_the_promise();
  EXPECT_GE(database.judged(1).triangles.size(), 1u) << "three samples are a finest triangle";
}

}  // namespace
}  // namespace talus::support
