// Danger: voids exactly on the borders of blocks, pages and tiles. All corners that coarse triangles stand on are void;
// whoever reads a void there as the number zero hangs the whole surface from sea level.

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr int kBorders[] = {64, 128, 1024};

Terrain ground(int cols, int rows) {
  Terrain terrain = surface(cols, rows, [](int col, int row) { return 3000 + (col * 3 + row) % 4; });
  for (const int border : kBorders) {
    terrain = hole(hole(terrain, border, 0, border, rows), 0, border, cols, border);
  }
  return terrain;
}

/// The error of a sample beside (64, 64) from a surface that stands on a void corner taken for zero.
double naive_error(const Terrain& t) {
  const double corner = t.is_valid(64, 64) ? t.at(64, 64) : 0;
  return std::abs(t.at(65, 65) - corner);
}

TEST(VoidBlockBorders, HangTheSurfaceFromZero) { EXPECT_GE(naive_error(ground(140, 140)), 3000); }

TEST(VoidBlockBorders, KeepThePromise) {
  for (const auto& [cols, rows] : {std::pair(1100, 140), std::pair(200, 200), std::pair(70, 1100)}) {
    HardCase hard{.terrain = ground(cols, rows)};
    hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
    hard.tolerances = {3, 10, 100, 1000};
    const HardDatabase database(hard);
    database.hold_to_the_promise();
    for (const double height : database.judged(100).heights) ASSERT_GE(height, 3000) << "a fill below all data";
  }
}

}  // namespace
}  // namespace talus::support
