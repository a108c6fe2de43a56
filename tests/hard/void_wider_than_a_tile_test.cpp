// Danger: a lake of voids wider than a tile. Corners of large triangles stand in the middle of it, far from any height;
// whoever fills them from what is near finds nothing, and zero there pulls the surface down by thousands of metres.

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr int kCols = 2600, kRows = 200;

Terrain ground() {
  const Terrain terrain = surface(kCols, kRows, [](int col, int row) { return 5000 + col / 8 + row; });
  return hole(terrain, 700, 30, 2300, kRows);  // the tile from column 1024 to 2047 has data in its north only
}

/// The nearest height within `reach`, else zero.
double naive_fill(const Terrain& t, int col, int row, int reach) {
  for (int r = std::max(0, row - reach); r <= std::min(kRows - 1, row + reach); ++r) {
    for (int c = col - reach; c <= col + reach; ++c) {
      if (t.is_valid(c, r)) return t.at(c, r);
    }
  }
  return 0;
}

TEST(VoidWiderThanATile, HasNoHeightNearItsMiddle) { EXPECT_EQ(naive_fill(ground(), 1536, 128, 64), 0); }

TEST(VoidWiderThanATile, KeepsThePromise) {
  for (const double weight : {1.0, 0.001}) {
    HardCase hard{.terrain = ground()};
    hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
    hard.void_weight = weight;
    hard.regions = {{{1000, 0}, {1100, 100}}, {{600, 100}, {760, 199}}};
    hard.tolerances = {1, 30, 200, 3000};
    const HardDatabase database(hard);
    if (weight == 1) database.hold_to_the_promise();
    for (const double tolerance : {1.0, 10.0, 1000.0, 1e5}) {
      for (const double height : database.judged(tolerance).heights) ASSERT_GE(height, 5000) << "at " << tolerance;
    }
  }
}

TEST(VoidWiderThanATile, OverAWholeTileKeepsThePromise) {
  HardCase hard{.terrain = hole(surface(kCols, kRows, [](int col, int row) { return 5000 + col / 8 + row; }), 900, 0,
                                2200, kRows)};
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  hard.tolerances = {1, 30, 200, 3000};
  HardDatabase(hard).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
