// Danger: heights of plus and minus a million metres with millimetres of detail. Between them lie 31 bits; a 32-bit
// float has 24, and all that is finer than six centimetres is lost before an error is computed.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

double height(int col, int row) {
  const double millimetres = (col * 7 + row * 3) % 11;
  return (col < 1024 ? 999999000 + millimetres : -999999000 - millimetres) / 1000;
}

float naive_error(double end, double midpoint, double other_end) {
  return std::abs(static_cast<float>(midpoint) - (static_cast<float>(end) + static_cast<float>(other_end)) / 2);
}

HardCase hard_case() {
  HardCase hard{.terrain = surface(1100, 140, height)};
  hard.file.type = SampleType::float64;
  hard.tolerances = {0.0005, 0.001, 0.004, 0.0055, 1e-9, 1e6, 1999998};
  return hard;
}

TEST(MillimetresAtAMillionMetres, AreLostInFloats) {
  const double exact = std::abs(height(65, 64) - (height(64, 64) + height(66, 64)) / 2);
  EXPECT_GT(exact, 0.005);
  EXPECT_EQ(naive_error(height(64, 64), height(65, 64), height(66, 64)), 0);
}

TEST(MillimetresAtAMillionMetres, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  EXPECT_TRUE(has_point(database.judged(0.004), {65, 64}));
}

}  // namespace
}  // namespace talus::support
