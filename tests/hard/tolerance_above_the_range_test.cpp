// Danger: a tolerance larger than the range of heights. Without voids nothing is needed then, but whoever takes this
// for a rule draws triangles across a lake of voids a kilometre wide.

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kLow = 400, kHigh = 410;

bool naive_needs_nothing(double tolerance) { return tolerance >= kHigh - kLow; }

HardCase hard_case(double weight) {
  HardCase hard{.terrain = hole(fit(noise(1100, 140, 2, kLow, kHigh), SampleType::int16), 40, 20, 1030, 110)};
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  hard.void_weight = weight;
  hard.tolerances = {10, 11, 20, 45, 46, 90};
  return hard;
}

TEST(ToleranceAboveTheRange, StillNeedsTheOutline) {
  EXPECT_TRUE(naive_needs_nothing(11));
  const HardDatabase database(hard_case(1));
  EXPECT_GT(database.judged(11).points.size(), database.judged(1e9).points.size());
}

TEST(ToleranceAboveTheRange, KeepsThePromise) {
  HardDatabase(hard_case(1)).hold_to_the_promise();
  HardDatabase(hard_case(0.25)).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
