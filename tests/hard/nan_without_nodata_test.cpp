// Danger: NaN samples in a file that names no number for voids, or names another. A comparison with the number never
// finds them, and one of them makes every error it touches no number at all.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kNodata = -9999;

bool naive_is_void(double sample) { return sample == kNodata; }

/// All voids are NaN; the file names another number for them, or none.
HardCase hard_case(SampleType type, bool named) {
  HardCase hard{.terrain = random_voids(hills(1100, 70), 0.01, 4)};
  hard.file.type = type;
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  hard.voids_are_nan = true;
  if (named) hard.file.nodata = kNodata;
  return hard;
}

TEST(NanWithoutNodata, IsNotFoundByComparison) {
  EXPECT_FALSE(naive_is_void(kNan));
  EXPECT_FALSE(std::abs(kNan - 500) > 1) << "and it is within every tolerance";
}

TEST(NanWithoutNodata, KeepsThePromise) {
  for (const SampleType type : {SampleType::float32, SampleType::float64}) {
    HardDatabase(hard_case(type, false)).hold_to_the_promise();
    HardDatabase(hard_case(type, true)).hold_to_the_promise();
  }
}

}  // namespace
}  // namespace talus::support
