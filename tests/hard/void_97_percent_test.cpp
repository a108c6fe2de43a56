// Danger: a raster of 97 percent voids that are NaN. A largest error that meets a NaN either becomes NaN for good or
// forgets what it had, by the order of its arguments; both compare as "within every tolerance".

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

float naive_largest(const std::vector<float>& distances) {
  float largest = 0;
  for (const float d : distances) largest = std::max(d, largest);  // NaN first stays; then nothing is larger
  return largest;
}

HardCase hard_case() {
  HardCase hard{.terrain = random_voids(hole(hills(1100, 140), 130, 0, 1010, 139), 0.85, 9)};
  hard.file.type = SampleType::float32;
  hard.file.nodata = std::numeric_limits<double>::quiet_NaN();
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  hard.tolerances = {0.5, 1, 2, 16, 100};
  return hard;
}

TEST(Void97Percent, MakesALargestErrorNoNumber) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float largest = naive_largest({3000, nan, 1});
  EXPECT_NE(largest, 3000);
  EXPECT_FALSE(largest > 10) << "so the vertex would not be selected";
}

TEST(Void97Percent, KeepsThePromise) {
  const HardCase hard = hard_case();
  const auto valid = std::count(hard.terrain.valid.begin(), hard.terrain.valid.end(), 1);
  EXPECT_LT(static_cast<double>(valid), 0.035 * static_cast<double>(hard.terrain.valid.size()));
  HardDatabase(hard).hold_to_the_promise();
}

TEST(Void97Percent, AsASliverKeepsThePromise) {
  HardCase hard{.terrain = hole(hills(1100, 140), 0, 0, 1099, 139)};
  for (int row = 0; row < 140; ++row) {
    for (int col = 990 + row / 3; col < 1020 + row / 3; ++col) hard.terrain.valid[hard.terrain.index(col, row)] = 1;
  }
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  HardDatabase(hard).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
