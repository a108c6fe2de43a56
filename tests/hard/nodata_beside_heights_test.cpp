// Danger: valid floats that lie close to the number for voids. Whoever compares with more slack than GDAL, which takes
// what is within five steps of a float for the number itself, makes holes where there is data.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

const float kNodata = -9999, kStep = std::nextafter(kNodata, 0.0F) - kNodata;
const float kAbove = kNodata + 8 * kStep, kBelow = kNodata - 8 * kStep;

bool naive_is_void(float sample) { return std::abs(sample - kNodata) < 0.01F; }

HardCase hard_case() {
  HardCase hard{.terrain = surface(200, 140, [](int col, int row) {
                  return (col + row) % 3 == 0 ? kAbove : (col + row) % 3 == 1 ? kBelow : kNodata + 1;
                })};
  hard.terrain = hole(hard.terrain, 60, 60, 70, 64);
  hard.file.type = SampleType::float32;
  hard.file.nodata = double{kNodata};
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  hard.tolerances = {0.0005, 0.001, 0.5, 1};
  return hard;
}

TEST(NodataBesideHeights, SwallowsThemWithSlack) {
  EXPECT_TRUE(naive_is_void(kAbove) && naive_is_void(kBelow));
  EXPECT_NE(kAbove, kNodata);
}

TEST(NodataBesideHeights, KeepsThePromise) { HardDatabase(hard_case()).hold_to_the_promise(); }

}  // namespace
}  // namespace talus::support
