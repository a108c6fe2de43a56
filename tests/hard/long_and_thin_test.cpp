// Danger: rasters very long and a few samples high. The root square over them has more samples than 32 bits count,
// although the raster has few; whoever sizes anything by the square gets nothing, or no memory.

#include <algorithm>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

std::uint32_t naive_root_samples(int cols) {
  std::uint32_t side = 1;
  while (side < static_cast<std::uint32_t>(cols)) side *= 2;
  return side * side;
}

HardCase hard_case(int cols, int rows) {
  HardCase hard{.terrain = fit(sine_hills(cols, rows, 300, 977), SampleType::int16)};
  for (int i = 0; i < cols * rows; i += 1023) hard.terrain.values[static_cast<std::size_t>(i)] = -2000;
  hard.tolerances = {20, 2000};
  hard.regions = {{{0, 0}, {std::min(cols - 1, 300), std::min(rows - 1, 300)}}};
  return hard;
}

TEST(LongAndThin, HasARootOfNoSamplesAtAll) { EXPECT_EQ(naive_root_samples(70000), 0u); }

TEST(LongAndThin, KeepsThePromise) {
  HardDatabase(hard_case(20001, 3)).hold_to_the_promise();
  HardDatabase(hard_case(5, 9000)).hold_to_the_promise();
}

TEST(LongAndThin, KeepsThePromiseOverManyTiles) {
  for (const auto& [cols, rows] : {std::pair(70000, 2), std::pair(2, 66000)}) {
    const HardDatabase database(hard_case(cols, rows));
    (void)database.judged(0);
    (void)database.judged(200);
  }
}

}  // namespace
}  // namespace talus::support
