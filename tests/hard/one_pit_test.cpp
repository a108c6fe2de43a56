// Danger: one sample lies below a plain. Whoever takes the largest of the differences, not of the distances, finds
// that no sample stands out.

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kDepth = 1500;

double naive_error(const Terrain& terrain, double plain) {
  double largest = 0;
  for (const double height : terrain.values) largest = std::max(largest, height - plain);
  return largest;
}

HardCase hard_case(int col, int row) {
  HardCase hard{.terrain = pit(140, 1100, col, row, kDepth)};
  hard.tolerances = {kDepth - 1, kDepth, kDepth + 1};
  return hard;
}

TEST(OnePit, IsNoLargestDifference) { EXPECT_EQ(naive_error(hard_case(65, 1023).terrain, 100), 0); }

TEST(OnePit, AtEveryKindOfBorderIsFoundAtItsDepth) {
  for (const int row : {63, 64, 65, 127, 128, 129, 1023, 1024, 1025}) {
    SCOPED_TRACE(row);
    const HardDatabase database(hard_case(65, row));
    EXPECT_TRUE(has_point(database.judged(kDepth - 1), {65, row}));
    EXPECT_EQ(database.judged(kDepth).points.size(), database.judged(1e9).points.size());
  }
}

TEST(OnePit, KeepsThePromise) { HardDatabase(hard_case(65, 1023)).hold_to_the_promise(); }

}  // namespace
}  // namespace talus::support
