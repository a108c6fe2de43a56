// Danger: rasters of one or two cells. The smallest power of two that holds one cell is one, without a level in it; a
// number of bands that is rounded down from so few levels is none, and nothing is stored.

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

int naive_bands(int cols, int rows) {
  int levels = 0;
  while (1 << levels < cols - 1 || 1 << levels < rows - 1) ++levels;
  return levels / 3;
}

TEST(GridsOfOneCell, HaveNoBand) {
  EXPECT_EQ(naive_bands(2, 2), 0);
  EXPECT_EQ(naive_bands(3, 3), 0);
}

TEST(GridsOfOneCell, KeepThePromise) {
  for (int cols = 2; cols <= 4; ++cols) {
    for (int rows = 2; rows <= 4; ++rows) {
      SCOPED_TRACE(::testing::Message() << cols << " x " << rows);
      HardCase hard{.terrain = fit(noise(cols, rows, 3), SampleType::int16)};
      hard.tolerances = {1, 100, 500};
      const HardDatabase database(hard);
      database.hold_to_the_promise();
      EXPECT_EQ(database.judged(0).triangles.empty(), false);
    }
  }
}

TEST(GridsOfOneCell, KeepThePromiseWithAVoid) {
  for (int corner = 0; corner < 4; ++corner) {
    HardCase hard{.terrain = plane(2, 2)};
    hard.terrain.make_void(corner % 2, corner / 2);
    HardDatabase(hard).hold_to_the_promise();
  }
}

}  // namespace
}  // namespace talus::support
