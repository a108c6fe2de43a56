// Danger: a raster in degrees a hundredth of a degree from the pole. The cosine of a latitude that is still in degrees
// is negative there, and so is every ground side: no outline is ever too coarse.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kDegrees = 1.0 / 12000;

double naive_width_m(double latitude) { return std::cos(latitude) * 111320 * kDegrees; }

HardCase hard_case() {
  HardCase hard{.terrain = void_blobs(hills(1100, 110), 6, 2)};
  hard.file.crs = "EPSG:4326";
  hard.file.geotransform = {-60, kDegrees, 0, 89.99, 0, -kDegrees};
  hard.judging = judging_in_degrees(hard.file, hard.terrain.rows);
  hard.tolerances = {1e-3, 9, 9.4, 20, 100};
  return hard;
}

TEST(Geographic8999, HasNegativeCellsInRadians) {
  EXPECT_LT(naive_width_m(89.99), 0);
  EXPECT_GT(hard_case().judging.cell_width_m, 0);
}

TEST(Geographic8999, KeepsThePromise) { HardDatabase(hard_case()).hold_to_the_promise(); }

}  // namespace
}  // namespace talus::support
