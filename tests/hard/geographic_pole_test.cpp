// Danger: a raster whose rows reach the pole and, with pixels as points, half a cell beyond it. Behind the pole a
// cosine is negative and on it not quite zero; whatever is multiplied or divided by it turns over or explodes.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kDegrees = 0.25;

double naive_width_m(double latitude) { return std::cos(latitude * 3.14159265358979323846 / 180) * 111320 * kDegrees; }

/// The north-west corner lies `beyond` degrees beyond the north pole.
HardCase hard_case(double beyond) {
  HardCase hard{.terrain = void_blobs(hills(1440, 64), 8, 5)};
  hard.file.crs = "EPSG:4326";
  hard.file.geotransform = {-180, kDegrees, 0, 90 + beyond, 0, -kDegrees};
  hard.judging = judging_in_degrees(hard.file, hard.terrain.rows);
  hard.tolerances = {0.001, 100, 28000, 30000, 100000};
  return hard;
}

TEST(GeographicPole, HasCellsOfNegativeWidthBehindIt) {
  EXPECT_LT(naive_width_m(90.125), 0);
  EXPECT_NE(naive_width_m(90), 0);
}

TEST(GeographicPole, KeepsThePromise) {
  HardDatabase(hard_case(0)).hold_to_the_promise();
  HardDatabase(hard_case(kDegrees / 2)).hold_to_the_promise();
}

TEST(GeographicPole, KeepsThePromiseInTheSouth) {
  HardCase hard = hard_case(0);
  hard.file.geotransform[3] = -90 + 63.5 * kDegrees;
  hard.judging = judging_in_degrees(hard.file, hard.terrain.rows);
  HardDatabase(hard).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
