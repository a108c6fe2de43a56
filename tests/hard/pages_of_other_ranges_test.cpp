// Danger: whole numbers whose range changes from page to page: one byte here, 16 bits there, a million metres in the
// next. Codes with the width of the first page, or of an average one, wrap around in the others.

#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

std::int32_t height(int col, int row) {
  const std::int32_t number = (col * 31 + row * 17) % 251;
  if (col < 128) return number;
  if (col < 1023) return number * 260 - 32768;
  return (row < 128 ? 1 : -1) * (1000000 - number);
}

/// In 16 bits above the lowest height of the first page, which is 0.
std::int32_t naive_stored(std::int32_t value) { return static_cast<std::uint16_t>(value); }

TEST(PagesOfOtherRanges, WrapAround) {
  EXPECT_EQ(naive_stored(height(5, 5)), height(5, 5));
  EXPECT_NE(naive_stored(height(129, 1)), height(129, 1));
  EXPECT_NE(naive_stored(height(1024, 5)), height(1024, 5));
}

TEST(PagesOfOtherRanges, KeepThePromise) {
  HardCase hard{.terrain = surface(1100, 140, height)};
  hard.file.type = SampleType::int32;
  hard.tolerances = {1, 100, 32768, 65536, 1e6, 2e6};
  HardDatabase(hard).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
