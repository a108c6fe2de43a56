// Danger: degrees at the equator, where they are longest. On a sphere of 6371 km a degree is 124 m too short there, and
// sides of triangles that are over the tolerance pass for ones within it.

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kDegrees = 1.0 / 1200;

double naive_side_m(int cells) { return cells * kDegrees * 6371000 * 3.14159265358979 / 180; }

/// Holes on the equator, between cells to the north and to the south of it.
HardCase hard_case() {
  HardCase hard{.terrain = hole(void_blobs(hills(300, 128), 4, 21), 1, 50, 90, 80)};
  hard.file.crs = "EPSG:4326";
  hard.file.geotransform = {20, kDegrees, 0, 64 * kDegrees, 0, -kDegrees};
  hard.judging = judging_in_degrees(hard.file, hard.terrain.rows);
  for (const int cells : {1, 2, 4, 8, 16, 32}) hard.tolerances.push_back(naive_side_m(cells));
  return hard;
}

TEST(GeographicEquator, IsLongerThanOnASphere) {
  const HardCase hard = hard_case();
  EXPECT_LT(naive_side_m(16), 16 * hard.judging.cell_width_m * 0.999);
}

TEST(GeographicEquator, KeepsThePromise) { HardDatabase(hard_case()).hold_to_the_promise(); }

}  // namespace
}  // namespace talus::support
