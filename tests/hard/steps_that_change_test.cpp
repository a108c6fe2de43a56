// Danger: floats whose step changes on the way: whole metres, then decimetres, millimetres, all bits, and heights of a
// million metres, with borders on those of pages and tiles. A step found in the first rows loses what comes later.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

float height(int col, int row) {
  const int part = col < 64 ? 0 : col < 128 ? 1 : col < 1023 ? 2 : col < 1025 ? 3 : 4;
  const int number = (col * 7 + row * 13) % 101;
  const double heights[] = {double(number), number / 10.0, number / 1000.0, number * std::sqrt(2.0), 1e6 - number};
  return static_cast<float>(heights[part]);
}

/// Heights in the step of the first sample that has one: whole metres.
double naive_stored(float value) { return std::round(value); }

TEST(StepsThatChange, LoseWhatComesLater) {
  EXPECT_EQ(naive_stored(height(5, 5)), height(5, 5));
  EXPECT_NE(naive_stored(height(65, 5)), height(65, 5));
  EXPECT_NE(naive_stored(height(1024, 5)), height(1024, 5));
}

TEST(StepsThatChange, KeepThePromise) {
  for (const SampleType type : {SampleType::float32, SampleType::float64}) {
    HardCase hard{.terrain = surface(1100, 140, height)};
    hard.file.type = type;
    hard.tolerances = {0.05, 0.1, 1, 50, 999999};
    HardDatabase(hard).hold_to_the_promise();
  }
}

}  // namespace
}  // namespace talus::support
