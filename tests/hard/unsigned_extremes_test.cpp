// Danger: unsigned 16-bit heights above 32767. Read as signed numbers the highest peak becomes -1 and stands
// one metre from the sea.

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

/// Takes the two bytes of a sample for a signed number.
int naive_height(std::uint16_t sample) { return static_cast<std::int16_t>(sample); }

/// Peaks of the largest number on a sea of zero, on both sides of the first tile's border.
HardCase hard_case() {
  HardCase hard{.terrain = surface(1100, 140, [](int col, int row) {
                  return (col + 3 * row) % 11 == 0 && col > 1000 ? 65535 : 32767 + (col + row) % 2;
                })};
  for (int row = 0; row < 140; ++row) hard.terrain.at(1024, row) = row % 2 == 0 ? 0 : 65535;
  hard.file.type = SampleType::uint16;
  hard.tolerances = {32767.5, 65534, 65535};
  return hard;
}

TEST(UnsignedExtremes, LookFlatAsSignedNumbers) {
  const HardCase hard = hard_case();
  const auto north = static_cast<std::uint16_t>(hard.terrain.at(1024, 64));
  const auto middle = static_cast<std::uint16_t>(hard.terrain.at(1024, 65));
  EXPECT_EQ(middle - north, 65535);
  EXPECT_EQ(std::abs(naive_height(middle) - naive_height(north)), 1);
}

TEST(UnsignedExtremes, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  EXPECT_TRUE(has_point(database.judged(60000), {1024, 65}));
}

}  // namespace
}  // namespace talus::support
