// Danger: one void sample, marked by a number no height has. Whoever takes the number for a height finds a pit of 32
// kilometres, or, worse, a mean that looks like terrain.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kNodata = -32768;

/// A void is the number that stands for it.
double naive_error(const Terrain& t, int col, int row) {
  const auto at = [&](int c) { return t.is_valid(c, row) ? t.at(c, row) : kNodata; };
  return std::abs(at(col) - (at(col - 1) + at(col + 1)) / 2);
}

HardCase hard_case(int col, int row) {
  HardCase hard{.terrain = hills(1100, 140, 20)};
  hard.terrain.make_void(col, row);
  hard.file.nodata = kNodata;
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  hard.tolerances = {1, 2, 40};
  return hard;
}

TEST(OneVoid, IsAPitOfThirtyKilometres) {
  EXPECT_GT(naive_error(hard_case(1024, 65).terrain, 1024, 65), 32000);
  EXPECT_GT(naive_error(hard_case(1024, 65).terrain, 1025, 65), 16000) << "and so are its neighbours";
}

TEST(OneVoid, BesideEveryKindOfBorderKeepsThePromise) {
  for (const int col : {0, 63, 64, 128, 1023, 1024, 1025, 1099}) {
    SCOPED_TRACE(col);
    const HardDatabase database(hard_case(col, 64));
    for (const double tolerance : {0.0, 2.0, 40.0}) {
      for (const double height : database.judged(tolerance).heights) ASSERT_NEAR(height, 500, 20);
    }
  }
}

TEST(OneVoid, KeepsThePromise) { HardDatabase(hard_case(1024, 65)).hold_to_the_promise(); }

}  // namespace
}  // namespace talus::support
