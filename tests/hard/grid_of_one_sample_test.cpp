// Danger: a raster of one sample. It has no cell, no triangle and no level; the logarithm of its zero cells is minus
// infinity, and no number of levels can be made of that.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

double naive_levels(int cols) { return std::ceil(std::log2(cols - 1)); }

TEST(GridOfOneSample, HasNoNumberOfLevels) { EXPECT_TRUE(std::isinf(naive_levels(1))); }

TEST(GridOfOneSample, KeepsThePromise) {
  for (const double height : {-417.0, 0.0, 32767.0}) {
    HardCase hard{.terrain = plane(1, 1, height, 0, 0)};
    const HardDatabase database(hard);
    database.hold_to_the_promise();
    EXPECT_TRUE(database.judged(0).triangles.empty());
  }
}

}  // namespace
}  // namespace talus::support
