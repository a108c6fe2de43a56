// Danger: bytes that use all of their 256 values, lowest beside highest. No value is left to mean a void, a sum of two
// wraps around, and whoever takes 0 or 255 for a void makes holes in the steepest places.

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

int naive_error(std::uint8_t end, std::uint8_t midpoint, std::uint8_t other_end) {
  return std::abs(midpoint - static_cast<std::uint8_t>(end + other_end) / 2);
}

HardCase hard_case() {
  HardCase hard{.terrain = surface(1100, 140, [](int col, int row) {
                  if (col == 1024 || col == 64) return row % 2 == 0 ? 255 : 0;
                  return (col + 3 * row) % 256;
                })};
  hard.file.type = SampleType::uint8;
  hard.tolerances = {127, 127.5, 128, 254, 255};
  return hard;
}

TEST(BytesOfAllValues, WrapAroundInEightBits) {
  const Terrain terrain = hard_case().terrain;
  const auto at = [&](int row) { return static_cast<std::uint8_t>(terrain.at(1024, row)); };
  EXPECT_EQ(std::abs(at(65) - (at(64) + at(66)) / 2), 255);
  EXPECT_LT(naive_error(at(64), at(65), at(66)), 128);
}

TEST(BytesOfAllValues, KeepThePromise) {
  const HardDatabase database(hard_case());
  EXPECT_EQ(database.now().description().void_samples, 0u);
  database.hold_to_the_promise();
  EXPECT_TRUE(has_point(database.judged(200), {1024, 65}));
}

}  // namespace
}  // namespace talus::support
