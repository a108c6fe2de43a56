// Danger: 32-bit floats of very different size side by side. The mean of 10⁶ and a centimetre, computed in floats,
// forgets the centimetre, so an error comes out too small and a sample leaves its tolerance.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr float kHigh = 1e6F, kLow = 0.01F;

float naive_error(float end, float midpoint, float other_end) { return std::abs(midpoint - (end + other_end) / 2); }

/// Peaks of a million metres in columns 1023 and 64, everything else small and fine.
HardCase hard_case() {
  HardCase hard{.terrain = surface(1100, 140, [](int col, int row) {
                  if (col == 1023 || col == 64) return row % 2 == 0 ? kHigh : -kHigh;
                  return kLow * static_cast<float>(1 + (col * 5 + row * 3) % 7);
                })};
  hard.file.type = SampleType::float32;
  hard.tolerances = {0.005, 0.01, 0.02, 499999.995, 500000};
  return hard;
}

TEST(Float32Absorption, MakesAnErrorTooSmall) {
  const float midpoint = 0.02F;
  const double exact = std::abs(double{midpoint} - (double{kHigh} + double{kLow}) / 2);
  EXPECT_EQ((kHigh + kLow) / 2, kHigh / 2) << "the centimetre is gone";
  EXPECT_LT(double{naive_error(kHigh, midpoint, kLow)}, exact - 0.01);
}

TEST(Float32Absorption, KeepsThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
