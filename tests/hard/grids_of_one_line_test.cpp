// Danger: rasters one sample wide or high. They have samples but no triangle; whatever is averaged over triangles or
// divided by the shorter side is no number.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

[[gnu::no_sanitize("float-divide-by-zero")]] double naive_mean_per_triangle(double sum, int cols, int rows) {
  return sum / (2.0 * (cols - 1) * (rows - 1));
}

TEST(GridsOfOneLine, HaveNoMeanPerTriangle) { EXPECT_TRUE(std::isnan(naive_mean_per_triangle(0, 1, 1100))); }

TEST(GridsOfOneLine, KeepThePromise) {
  for (const int length : {2, 3, 64, 65, 129, 1024, 1025, 2100}) {
    SCOPED_TRACE(length);
    for (const bool column : {true, false}) {
      const HardCase hard{.terrain = column ? hills(1, length) : hills(length, 1)};
      const HardDatabase database(hard);
      database.hold_to_the_promise();
      EXPECT_TRUE(database.judged(0).triangles.empty());
    }
  }
}

TEST(GridsOfOneLine, KeepThePromiseWithVoids) {
  const HardCase hard{.terrain = random_voids(hills(1100, 1), 0.3, 5)};
  HardDatabase(hard).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
