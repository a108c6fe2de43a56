// Longitudes that differ by a full turn name one place.

#include "engine/geo/longitude.hpp"

#include <cmath>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

/// Cells of a degree, from a west end on.
Description degrees(double west, std::int32_t cols, std::int32_t rows = 10) {
  Description d;
  d.crs = {"WGS 84", 4326, true, 1, 1, 6378137, 1 / 298.257223563};
  d.mapping = {west, 5, 1, -1};
  d.extent = {{0, 0}, {cols - 1, rows - 1}};
  return d;
}

TEST(Longitude, OnlyGeographicCoordinatesHaveATurn) {
  EXPECT_EQ(Longitudes(degrees(0, 10)).turn(), 360);
  Description gon = degrees(0, 10);
  gon.crs.degrees_per_unit = 0.9;
  EXPECT_NEAR(Longitudes(gon).turn(), 400, 1e-9);
  const Longitudes none{Description{}};
  EXPECT_EQ(none.turn(), 0);
  EXPECT_EQ(none.among({725, 3}, {{0, 0}, {9, 9}}), (Position{725, 3}));
  EXPECT_EQ(none.shifts(700, 800, {{0, 0}, {9, 9}}), std::vector<double>{0});
  EXPECT_EQ(none.among(Rectangle{3, 0, 1, 5}).xmin, 3);
}

TEST(Longitude, APointIsWrittenAsTheSamplesAreWhereverItLiesAmongThem) {
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const double west = random.between(-200, 200);
    const int cols = random.between(2, 359);
    const Description d = degrees(west, cols);
    const Longitudes longitudes(d);
    // Some place from a cell before the samples to a cell behind, on another turn.
    const double x = random.within(west - 1.5, west + cols + 0.5), turns = random.between(-3, 3) * 360.0;
    const Position found = longitudes.among({x + turns, 2}, d.extent);
    EXPECT_EQ(found.y, 2);
    const bool is_inside = x >= west - 0.5 && x <= west + cols - 0.5;
    if (is_inside && cols < 358) {
      EXPECT_NEAR(found.x, x, 1e-9) << west << " " << cols;
    } else if (!is_inside && cols < 350) {
      EXPECT_EQ(found.x, x + turns) << "as it is";
    }
  }
}

TEST(Longitude, ALineGoesTheShortWay) {
  const Longitudes longitudes(degrees(0, 10));
  const std::vector<Position> line{{170, 1}, {-170, 2}, {-179, 3}, {1, 4}, {359, 5}, {719, 6}};
  const std::vector<Position> way = longitudes.short_way(line);
  ASSERT_EQ(way.size(), line.size());
  EXPECT_EQ(way[1], (Position{190, 2}));
  EXPECT_EQ(way[2], (Position{181, 3}));
  for (std::size_t i = 1; i < way.size(); ++i) {
    EXPECT_LE(std::abs(way[i].x - way[i - 1].x), 180);
    EXPECT_NEAR(std::remainder(way[i].x - line[i].x, 360), 0, 1e-9) << "the same place";
    EXPECT_EQ(way[i].y, line[i].y);
  }
  const std::vector<Position> half{{0, 0}, {180, 0}};
  EXPECT_EQ(longitudes.short_way(half), half) << "half a turn stays as it is written";
}

TEST(Longitude, ShiftsAreAllTurnsOnWhichALineMeetsTheSamples) {
  Random random(2);
  for (int i = 0; i < 3000; ++i) {
    const double west = random.between(-200, 200);
    const int cols = random.between(2, 800);
    const Description d = degrees(west, cols);
    const double from = random.within(-600, 600), to = from + random.within(-100, 100);
    std::vector<double> expected;
    for (int turns = -10; turns <= 10; ++turns) {
      const double low = std::min(from, to) + turns * 360, high = std::max(from, to) + turns * 360;
      if (high >= west && low <= west + cols - 1) expected.push_back(turns * 360.0);
    }
    if (expected.empty()) expected.push_back(0);
    EXPECT_EQ(Longitudes(d).shifts(from, to, d.extent), expected);
  }
  const Description d = degrees(0, 10);
  EXPECT_EQ(Longitudes(d).shifts(1e300, 1e300, d.extent), std::vector<double>{0}) << "it ends";
}

TEST(Longitude, ABoxIsWrittenAsTheSamplesAre) {
  const Longitudes alps(degrees(5, 11));  // 5 to 15
  const auto x_of = [](const Rectangle& r) { return std::pair{r.xmin, r.xmax}; };
  EXPECT_EQ(x_of(alps.among(Rectangle{366, 0, 370, 5})), (std::pair{6.0, 10.0}));
  EXPECT_EQ(x_of(alps.among(Rectangle{-354, 0, -350, 5})), (std::pair{6.0, 10.0}));
  EXPECT_EQ(x_of(alps.among(Rectangle{-180, 0, 180, 5})), (std::pair{4.5, 15.5})) << "all longitudes";
  EXPECT_EQ(x_of(alps.among(Rectangle{100, 0, 120, 5})), (std::pair{100.0, 120.0})) << "nothing is there";
  const Longitudes pacific(degrees(175, 11));  // 175 to 185
  EXPECT_EQ(x_of(pacific.among(Rectangle{178, 0, -178, 5})), (std::pair{178.0, 182.0})) << "across the antimeridian";
  EXPECT_EQ(x_of(pacific.among(Rectangle{10, 0, 5, 5})), (std::pair{10.0, 5.0})) << "the long way is a mistake";
  const Longitudes globe(degrees(-180, 360));
  try {
    static_cast<void>(globe.among(Rectangle{170, 0, 190, 5}));
    ADD_FAILURE() << "lies at both ends";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::invalid_argument);
    EXPECT_THAT(failure.what(), ::testing::HasSubstr("-180,0,-170,5 and for 170,0,179,5"));
  }
}

}  // namespace
}  // namespace talus::support
