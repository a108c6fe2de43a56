// Danger: cells two hundred times as high as wide, beside voids. Whoever measures a side by the width of a cell finds
// an outline fine that is coarse by a factor of two hundred.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kWidth = 1, kHeight = 200;

double naive_side_m(int cols, int rows) { return std::hypot(cols, rows) * kWidth; }

HardCase hard_case(double width, double height) {
  HardCase hard{.terrain = void_blobs(hills(300, 140), 5, 11)};
  hard.file.geotransform = {0, width, 0, 0, 0, -height};
  hard.judging = {.cell_width_m = width, .cell_height_m = height};
  hard.void_weight = 0.5;
  hard.tolerances = {1, 10, 100, 101, 500, 5000};
  return hard;
}

TEST(CellsNotSquare, AreMeasuredTooShort) { EXPECT_LT(naive_side_m(0, 8), 8 * kHeight / 100); }

TEST(CellsNotSquare, KeepThePromise) {
  HardDatabase(hard_case(kWidth, kHeight)).hold_to_the_promise();
  HardDatabase(hard_case(kHeight, kWidth)).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
