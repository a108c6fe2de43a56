// Danger: a raster that crosses the antimeridian, from 179.5° to 180.5° east. Whoever brings longitudes back between
// -180° and 180° one by one makes it 359° wide and turns its rectangles inside out.

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kDegrees = 1.0 / 1200;

double naive_longitude(double x) { return x > 180 ? x - 360 : x; }

HardCase hard_case() {
  HardCase hard{.terrain = hole(hills(1200, 140), 580, 30, 640, 70)};
  hard.file.crs = "EPSG:4326";
  hard.file.geotransform = {179.5, kDegrees, 0, -16, 0, -kDegrees};
  hard.judging = judging_in_degrees(hard.file, hard.terrain.rows);
  hard.tolerances = {90, 178, 179, 1000};
  hard.regions = {{{590, 10}, {610, 139}}};
  return hard;
}

TEST(GeographicAntimeridian, TurnsRectanglesInsideOut) { EXPECT_LT(naive_longitude(180.25), naive_longitude(179.75)); }

TEST(GeographicAntimeridian, KeepsThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const GridRect across = database.now().region({179.9, -16.1, 180.1, -16.01}).samples;
  EXPECT_TRUE(across.contains({600, 60}));
  EXPECT_NEAR(static_cast<double>(across.cols()), 0.2 * 1200, 3);
  (void)database.judged(across, 5);
}

}  // namespace
}  // namespace talus::support
