// Danger: planes of any slope at tolerance 0. Nothing but the border needs a vertex, unless the plane is computed
// through a unit normal in floats, whose rounding makes every sample an error.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

struct Slope {
  double east, south;
};
constexpr Slope kSlopes[] = {{0, 0}, {1, 0}, {0, -1}, {13, -7}, {-7, 111}, {3, 3}, {-1, 1}};

float naive_height(Slope slope, float col, float row) {
  const auto east = static_cast<float>(slope.east), south = static_cast<float>(slope.south);
  const float length = std::sqrt(east * east + south * south + 1);
  const float nx = -east / length, ny = -south / length, nz = 1 / length;
  return -(nx * col + ny * row) / nz;
}

void expect_only_the_border(const HardDatabase& database) {
  EXPECT_EQ(database.judged(0).points.size(), database.judged(1e9).points.size());
}

TEST(ExactPlanes, AreNotExactThroughAUnitNormal) {
  float worst = 0;
  for (int col = 0; col < 1100; ++col) {
    const auto x = static_cast<float>(col);
    worst = std::max(worst, std::abs(naive_height({13, -7}, x, 139) - (13 * x - 7 * 139)));
  }
  EXPECT_GT(worst, 0);
}

TEST(ExactPlanes, OfWholeNumbersNeedTheBorderOnly) {
  for (const Slope slope : kSlopes) {
    SCOPED_TRACE(::testing::Message() << slope.east << " east, " << slope.south << " south");
    expect_only_the_border(HardDatabase({.terrain = plane(1100, 140, 100, slope.east, slope.south)}));
  }
  HardDatabase({.terrain = plane(1100, 140, 100, 13, -7)}).hold_to_the_promise();
}

TEST(ExactPlanes, OfBinaryFractionsNeedTheBorderOnly) {
  for (const SampleType type : {SampleType::float32, SampleType::float64}) {
    HardCase hard{.terrain = plane(140, 1100, -20, 3.0 / 128, -1.0 / 64)};
    hard.file.type = type;
    const HardDatabase database(hard);
    database.hold_to_the_promise();
    expect_only_the_border(database);
  }
}

}  // namespace
}  // namespace talus::support
