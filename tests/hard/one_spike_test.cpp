// Danger: one sample stands out of a plain. Whoever looks at means, at overviews or at every second sample does not
// see it, least of all where tiles, pages and blocks meet.

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kHeight = 50;
constexpr int kRow = 65;

/// What is left of the spike in an overview that averages squares of so many samples a side.
double naive_error(int side) { return kHeight / (side * side); }

TEST(OneSpike, IsNothingInAMean) {
  EXPECT_LT(naive_error(64), 0.02);
  EXPECT_LT(naive_error(1024), 0.0001);
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
