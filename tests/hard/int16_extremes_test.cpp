// Danger: the lowest and the highest 16-bit heights side by side. Their difference and their sum need 17 bits, so
// arithmetic that stays in 16 wraps around, and the steepest terrain there is looks half as steep or smooth.

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr std::int16_t kLow = -32768, kHigh = 32767;

std::int16_t wrapped(int value) { return static_cast<std::int16_t>(static_cast<std::uint16_t>(value)); }

/// The distance of a midpoint from the mean of its ends, as 16-bit lanes would have it.
int naive_error(std::int16_t end, std::int16_t midpoint, std::int16_t other_end) {
  return std::abs(wrapped(midpoint - wrapped(end + other_end) / 2));
}

/// Extremes where tiles, pages and blocks meet; hills elsewhere.
HardCase hard_case() {
  HardCase hard{.terrain = hills(1100, 140)};
  for (int row = 0; row < 140; ++row) {
    for (const int border : {64, 128, 1024}) {
      for (int col = border - 1; col <= border + 1; ++col) {
        hard.terrain.at(col, row) = (col + row) % 2 == 0 ? kLow : kHigh;
      }
    }
  }
  hard.file.nodata = -12345;
  hard.tolerances = {32767, 32768, 65534, 65535};
  return hard;
}

TEST(Int16Extremes, WrapAroundInSixteenBits) {
  EXPECT_EQ(std::abs(kHigh - (kLow + kLow) / 2), 65535);
  EXPECT_LE(naive_error(kLow, kHigh, kLow), 32767);
  EXPECT_LE(naive_error(kHigh, kLow, kHigh), 32767);
}

TEST(Int16Extremes, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  EXPECT_TRUE(has_point(database.judged(40000), {1023, 64}));
}

}  // namespace
}  // namespace talus::support
