// Points on the ellipsoid, against the textbook's formula and its inverse by steps.

#include "engine/geo/globe.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

CrsFacts wgs84(double degrees_per_unit = 1) {
  return {"WGS 84", 4326, true, 1, degrees_per_unit, 6378137, 1 / 298.257223563};
}

std::array<double, 3> from_the_centre(double lon, double lat, double h) {
  const double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f), rad = std::numbers::pi / 180;
  const double s = std::sin(lat * rad), c = std::cos(lat * rad), n = a / std::sqrt(1 - e2 * s * s);
  return {(n + h) * c * std::cos(lon * rad), (n + h) * c * std::sin(lon * rad), (n * (1 - e2) + h) * s};
}

TEST(Globe, CountsFromTheCentreOfTheEarth) {
  const Globe globe(wgs84());
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double lon = random.within(-400, 400), lat = random.within(-90, 90), h = random.within(-500, 9000);
    const auto p = globe.at({lon, lat}, h), expected = from_the_centre(lon, lat, h);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(p[axis], expected[axis], 1e-8);
  }
  EXPECT_NEAR(globe.at({0, 0}, 0)[0], 6378137, 1e-8);
  EXPECT_NEAR(globe.at({90, 0}, 0)[1], 6378137, 1e-8);
  EXPECT_NEAR(globe.at({0, 90}, 0)[2], 6356752.314245, 1e-6);
}

TEST(Globe, TakesCoordinatesInTheUnitOfTheCrs) {
  const Globe degrees(wgs84()), gon(wgs84(0.9));
  EXPECT_EQ(gon.at({10, 50}, 7), degrees.at({9, 45}, 7));
  const Globe from_there(wgs84(0.9), {10, 50}, 100);
  for (const double v : from_there.at({10, 50}, 100)) EXPECT_NEAR(v, 0, 1e-8);
}

TEST(Globe, CountsEastNorthAndUpFromAPoint) {
  const Globe globe(wgs84(), {7, 46}, 1000);
  const auto up = globe.at({7, 46}, 1250);
  EXPECT_NEAR(up[0], 0, 1e-8);
  EXPECT_NEAR(up[1], 0, 1e-8);
  EXPECT_NEAR(up[2], 250, 1e-8);
  const auto east = globe.at({7.001, 46}, 1000), north = globe.at({7, 46.001}, 1000);
  EXPECT_NEAR(east[0], 77.5, 0.2);
  EXPECT_NEAR(east[1], 0, 0.01);
  EXPECT_NEAR(north[0], 0, 1e-8);
  EXPECT_NEAR(north[1], 111.2, 0.2);
  EXPECT_LT(north[2], 0) << "the Earth falls away";
  // Distances are those from the centre.
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Position a{random.within(6, 8), random.within(45, 47)}, b{random.within(6, 8), random.within(45, 47)};
    const auto p = globe.at(a, 10), q = globe.at(b, 900), r = from_the_centre(a.x, a.y, 10),
               s = from_the_centre(b.x, b.y, 900);
    EXPECT_NEAR(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), std::hypot(r[0] - s[0], r[1] - s[1], r[2] - s[2]),
                1e-6);
  }
}

TEST(Globe, BeyondAPoleIsThePoleButNoOrigin) {
  const Globe globe(wgs84());
  EXPECT_EQ(globe.at({7, 90.001}, 5), globe.at({7, 90}, 5)) << "half a cell beyond the last sample";
  EXPECT_EQ(globe.at({7, -91}, 5), globe.at({7, -90}, 5));
  EXPECT_NO_THROW(Globe(wgs84(), {7, 90}, 0));
  for (const double lat : {90.001, -91.0, std::nan("")}) {
    try {
      const Globe there(wgs84(), {7, lat}, 0);
      ADD_FAILURE() << lat;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.cause(), Cause::invalid_argument);
    }
  }
}

}  // namespace
}  // namespace talus::support
