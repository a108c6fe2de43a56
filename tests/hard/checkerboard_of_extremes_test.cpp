// Danger: extremes in a checkerboard. All samples with even coordinates are equal, so at every spacing but the finest
// each midpoint lies exactly between its ends, and a search from the top stops at the first triangle.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kLow = -32767, kHigh = 32767;

double naive_error(const Terrain& terrain, GridPoint vertex, int s) {
  const double ends = terrain.at(vertex.col - s, vertex.row) + terrain.at(vertex.col + s, vertex.row);
  return std::abs(terrain.at(vertex.col, vertex.row) - ends / 2);
}

HardCase hard_case() {
  HardCase hard{.terrain = checkerboard(1100, 140, kLow, kHigh)};
  hard.tolerances = {32767, 65533, 65534, 65535};
  return hard;
}

TEST(CheckerboardOfExtremes, HasMidpointErrorsOfZero) {
  const HardCase hard = hard_case();
  for (int s = 2; s <= 512; s *= 2) EXPECT_EQ(naive_error(hard.terrain, {s, 64}, s), 0) << "spacing " << s;
  EXPECT_EQ(naive_error(hard.terrain, {1, 64}, 1), kHigh - kLow);
}

TEST(CheckerboardOfExtremes, KeepsThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  EXPECT_GT(database.judged(60000).points.size(), database.truth().values.size() / 3);
}

}  // namespace
}  // namespace talus::support
