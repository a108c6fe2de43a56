// Danger: a raster around the whole globe, from pole to pole. Its first and last columns stand half a cell from the
// antimeridian on either side; whoever measures a side by the difference of longitudes, brought between -180° and 180°,
// finds one of 359 degrees to be one degree long.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kDegrees = 0.5;

double naive_degrees(double from, double to) { return std::abs(std::remainder(to - from, 360)); }

HardCase hard_case() {
  HardCase hard{.terrain = void_blobs(hills(720, 360, 400), 7, 13)};
  hard.file.crs = "EPSG:4326";
  hard.file.geotransform = {-180, kDegrees, 0, 90, 0, -kDegrees};
  hard.judging = judging_in_degrees(hard.file, hard.terrain.rows);
  hard.tolerances = {100, 60000, 1e6, 1e7, 5e7};
  hard.regions = {{{0, 100}, {719, 260}}, {{700, 0}, {719, 359}}, {{0, 0}, {40, 40}}};
  return hard;
}

TEST(GeographicWholeGlobe, IsOneDegreeWideTheOtherWayRound) {
  EXPECT_LT(naive_degrees(-179.75, 179.75), 1);
  EXPECT_GT(179.75 - -179.75, 359);
}

TEST(GeographicWholeGlobe, KeepsThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  EXPECT_EQ(database.now().region({-180, -90, 180, 90}).samples, database.extent());
}

}  // namespace
}  // namespace talus::support
