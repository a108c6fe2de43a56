// Longitudes that differ by a full turn are one place, for every question; held against the raster's own samples.

#include <cmath>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/random_raster.hpp"

namespace talus {
namespace {

using namespace support;

struct Placed {
  double west, north, cell;
  const char* crs;
  double turn;
};

Snapshot snapshot_of(const Terrain& terrain, const Placed& at, const TempFolder& folder) {
  RasterOptions file;
  file.type = SampleType::float64;
  file.crs = at.crs;
  file.geotransform = {at.west, at.cell, 0, at.north, 0, -at.cell};
  write_raster(terrain, folder / "a.tif", file);
  IngestOptions again;
  again.overwrite = true;
  ingest(folder / "a.tif", folder / "a.talus", again);
  return Database::open(folder / "a.talus").snapshot();
}

// NTF (Paris) counts in grads: 400 are a turn.
const std::vector<Placed> kPlaces{{179, 52, 0.01, "EPSG:4326", 360},  {-181, 52, 0.01, "EPSG:4326", 360},
                                  {-180, 52, 0.01, "EPSG:4326", 360}, {178, 52, 0.01, "EPSG:4326", 360},
                                  {7, 46, 0.01, "EPSG:4326", 360},    {359, 10, 0.01, "EPSG:4326", 360},
                                  {199, 52, 0.01, "EPSG:4807", 400}};

std::string name_of(const Placed& at) { return std::string(at.crs) + " at " + std::to_string(at.west); }

TEST(Longitudes, APointIsAnsweredOnEveryTurn) {
  const Terrain terrain = random_voids(fractal(200, 100, 3, 500), 0.02, 4);
  for (const Placed& at : kPlaces) {
    SCOPED_TRACE(name_of(at));
    const TempFolder folder;
    const Snapshot now = snapshot_of(terrain, at, folder);
    Random random(5);
    for (int i = 0; i < 200; ++i) {
      const int col = random.between(0, 199), row = random.between(0, 99);
      const double x = at.west + (col + 0.5) * at.cell, y = at.north - (row + 0.5) * at.cell;
      for (const int turns : {-3, -1, 0, 1, 2}) {
        const double written = x + turns * at.turn;
        EXPECT_TRUE(is_inside(now, {written, y}));
        const auto found = now.height(written, y);
        ASSERT_EQ(found.has_value(), terrain.is_valid(col, row)) << written;
        if (found) {
          EXPECT_EQ(*found, terrain.at(col, row)) << written;
        }
        EXPECT_EQ(now.height(written, y, Metres{20}), now.height(x, y, Metres{20}));
      }
      EXPECT_FALSE(is_inside(now, {x + at.turn / 2, y}));
      EXPECT_FALSE(now.height(x + at.turn / 2, y).has_value());
    }
  }
}

TEST(Longitudes, ABoxIsAnsweredOnEveryTurn) {
  const Terrain terrain = fractal(200, 100, 3, 500);
  for (const Placed& at : kPlaces) {
    SCOPED_TRACE(name_of(at));
    const TempFolder folder;
    const Snapshot now = snapshot_of(terrain, at, folder);
    const double south = at.north - 0.7, north = at.north - 0.205;
    const GridRect first = now.description().extent;
    const GridRect expected{{first.first.col + 49, first.first.row + 20},
                            {first.first.col + 151, first.first.row + 70}};
    const double west = at.west + 0.5, east = at.west + 1.51;
    for (const int turns : {-2, -1, 0, 1}) {
      const Rectangle box{west + turns * at.turn, south, east + turns * at.turn, north};
      EXPECT_EQ(now.region(box).samples, expected) << turns;
      EXPECT_FALSE(now.region(box).is_cut);
      const Frame frame = now.region(box).frame, plain = now.region({west, south, east, north}).frame;
      EXPECT_NEAR(frame.west, plain.west, 1e-6);
      EXPECT_NEAR(frame.east, plain.east, 1e-6);
      EXPECT_EQ(now.mesh(box, Metres{5}).triangles, now.mesh({west, south, east, north}, Metres{5}).triangles);
    }
    // West and east on turns of their own, as ±180 and less are written: xmin > xmax.
    EXPECT_EQ(now.region({west, south, east - at.turn, north}).samples, expected);
    EXPECT_THROW(static_cast<void>(now.region({east, south, west, north}).samples), Failure) << "swapped";
    EXPECT_THROW(static_cast<void>(now.region({west + at.turn / 2, south, east + at.turn / 2, north}).samples),
                 Failure);
    EXPECT_EQ(now.region({-3 * at.turn, south, at.turn, north}).samples.cols(), 200) << "all longitudes";
    // Cut boxes say so, those of the outermost cells are none.
    EXPECT_FALSE(now.region({at.west, at.north - 1, at.west + 2, at.north}).is_cut);
    EXPECT_TRUE(now.region({at.west - 0.02 + at.turn, south, east + at.turn, north}).is_cut);
    EXPECT_TRUE(now.region({west, south, at.west + 2.02, north}).is_cut);
    EXPECT_TRUE(now.region({west, at.north - 1.02, east, north}).is_cut);
    EXPECT_TRUE(now.region({west, south, east, at.north + 0.02}).is_cut);
  }
}

TEST(Longitudes, ALineGoesTheShortWay) {
  const Terrain terrain = plane(200, 100, 300, 1.5, -2);
  const TempFolder folder;
  const Placed at{179, 52, 0.01, "EPSG:4326", 360};
  const Snapshot now = snapshot_of(terrain, at, folder);
  const std::vector<Position> through{{179.505, 51.505}, {180.505, 51.505}};
  const Profile expected = now.profile(through, Metres{0});
  EXPECT_NEAR(expected.length.value, 69'400, 300);  // a degree of longitude at 51.5° north: 111.32 km · cos
  for (const auto& line :
       std::vector<std::vector<Position>>{{{179.505, 51.505}, {-179.495, 51.505}},
                                          {{-180.495, 51.505}, {-179.495, 51.505}},
                                          {{-180.495, 51.505}, {180.505, 51.505}},
                                          {{179.505, 51.505}, {-179.745, 51.505}, {180.505, 51.505}}}) {
    SCOPED_TRACE(::testing::PrintToString(line.front().x) + " to " + ::testing::PrintToString(line.back().x));
    const Profile found = now.profile(line, Metres{0});
    EXPECT_NEAR(found.length.value, expected.length.value, 1e-3);
    ASSERT_EQ(found.parts.size(), 1u);
    EXPECT_NEAR(found.parts[0].back().distance.value, expected.length.value, 1e-3);
    EXPECT_NEAR(found.parts[0].front().height, terrain.at(50, 49), 1e-6);
    EXPECT_NEAR(found.parts[0].back().height, terrain.at(150, 49), 1e-6);
    EXPECT_EQ(found.parts[0].front().x, line[0].x) << "in the writing of the line's first point";
    EXPECT_NEAR(found.parts[0].back().x, line[0].x + 1, 1e-9);
  }
  // The other way round, and a point in between for who wants the long way.
  EXPECT_NEAR(now.profile(std::vector<Position>{{-179.495, 51.505}, {179.505, 51.505}}, Metres{0}).length.value,
              expected.length.value, 1e-3);
  const Profile around =
      now.profile(std::vector<Position>{{179.505, 51.505}, {60, 51.505}, {-60, 51.505}, {-179.495, 51.505}}, Metres{0});
  EXPECT_NEAR(around.length.value, 24'929'000, 40'000);
  ASSERT_EQ(around.parts.size(), 2u) << "it leaves in the west and comes back in the east";
  EXPECT_THROW(static_cast<void>(now.profile(std::vector<Position>{{180, 51.5}, {-180, 51.5}}, Metres{0})), Failure)
      << "one place";
}

TEST(Longitudes, PointsAndLinesOfInterestAreTaken) {
  const Terrain terrain = fractal(200, 100, 3, 500);
  const TempFolder folder;
  const Snapshot now = snapshot_of(terrain, {179, 52, 0.01, "EPSG:4326", 360}, folder);
  const Description& d = now.description();
  const std::vector<Position> points{{179.305, 51.505}, {-179.795, 51.495}, {-180.695, 51.505}, {540.305, 51.505}};
  EXPECT_EQ(samples_nearest(d, d.extent, points), (std::vector<GridPoint>{{30, 49}, {120, 50}, {30, 49}, {130, 49}}));
  const std::vector<Position> line{{179.905, 51.505}, {-179.905, 51.505}};
  const std::vector<GridPoint> along = samples_along(d, d.extent, line);
  ASSERT_EQ(along.size(), 20u);
  EXPECT_EQ(along.front(), (GridPoint{90, 49}));
  EXPECT_EQ(along.back(), (GridPoint{109, 49}));
  const auto here = focus_tolerance(d, 180.305, 51.505, 1, Metres{2}),
             there = focus_tolerance(d, -179.695, 51.505, 1, Metres{2});
  EXPECT_NEAR(there->at({130, 49}).value, 2, 1e-6);
  EXPECT_NEAR(there->at({10, 10}).value, here->at({10, 10}).value, 1e-6);
  const std::vector<Position> outside{{178.5, 51.5}};
  EXPECT_THROW(static_cast<void>(samples_nearest(d, d.extent, outside)), Failure);
}

TEST(Longitudes, AWholeGlobeAnswersWhatItAnswered) {
  const Terrain terrain = fractal(361, 181, 6, 900);
  const TempFolder folder;
  // Samples on whole degrees, both ends the same meridian; and pixels from −180 to 180.
  const Snapshot inclusive = snapshot_of(terrain, {-180.5, 90.5, 1, "EPSG:4326", 360}, folder);
  EXPECT_EQ(inclusive.height(-180, 10), terrain.at(0, 80));
  EXPECT_EQ(inclusive.height(180, 10), terrain.at(360, 80));
  EXPECT_EQ(inclusive.height(179, 10), terrain.at(359, 80));
  EXPECT_EQ(inclusive.height(-181, 10), terrain.at(359, 80));
  EXPECT_EQ(inclusive.height(190, 10), terrain.at(10, 80));
  EXPECT_EQ(inclusive.region({-180, -90, 180, 90}).samples, inclusive.description().extent);
  EXPECT_EQ(inclusive.region({-200, -90, 200, 90}).samples, inclusive.description().extent);
  EXPECT_EQ(inclusive.region({0, -90, 360, 90}).samples, inclusive.description().extent);
  EXPECT_EQ(inclusive.region({-180, 0, -170, 10}).samples.cols(), 11);
  EXPECT_EQ(inclusive.region({170, 0, 180, 10}).samples.first.col, inclusive.description().extent.first.col + 350);
  EXPECT_EQ(inclusive.region({190, 0, 200, 10}).samples.first.col, inclusive.description().extent.first.col + 10);
  EXPECT_FALSE(inclusive.region({-180, -90, 180, 90}).is_cut);
  try {
    static_cast<void>(inclusive.region({175, 0, -175, 10}).samples);
    FAIL() << "both ends in one rectangle";
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("175,0,180,10"), std::string::npos) << failure.what();
    EXPECT_NE(std::string(failure.what()).find("-180,0,-175,10"), std::string::npos) << failure.what();
  }
  const Profile across = inclusive.profile(std::vector<Position>{{175, 10}, {-175, 10}}, Metres{0});
  EXPECT_NEAR(across.length.value, 10 * 109'640, 3000);
  ASSERT_EQ(across.parts.size(), 1u) << "without a gap where the raster's ends meet";
  EXPECT_NEAR(across.parts[0].front().height, terrain.at(355, 80), 1e-6);
  EXPECT_NEAR(across.parts[0].back().height, terrain.at(5, 80), 1e-6);
  const std::vector<Position> line{{178, 10}, {-178, 10}};
  const Description& d = inclusive.description();
  EXPECT_EQ(samples_along(d, d.extent, line),
            (std::vector<GridPoint>{{358, 80}, {359, 80}, {360, 80}, {0, 80}, {1, 80}, {2, 80}}));
  EXPECT_NEAR(inclusive.profile(std::vector<Position>{{-80, 10}, {80, 10}}, Metres{0}).length.value, 160 * 109'640,
              40'000);
}

TEST(Longitudes, OtherCrsHaveNoTurn) {
  const Terrain terrain = fractal(200, 100, 3, 500);
  const TempFolder folder;
  for (const char* crs : {"EPSG:32632", ""}) {
    const Snapshot now = snapshot_of(terrain, {100, 52, 0.01, crs, 360}, folder);
    EXPECT_TRUE(is_inside(now, {101, 51.5}));
    EXPECT_FALSE(is_inside(now, {101 - 360, 51.5}));
    EXPECT_FALSE(now.height(101 + 360, 51.5).has_value());
    EXPECT_THROW(static_cast<void>(now.region({100.5 - 360, 51.2, 101.5 - 360, 51.5}).samples), Failure);
    EXPECT_THROW(static_cast<void>(now.region({101.5, 51.2, 100.5, 51.5}).samples), Failure);
    EXPECT_EQ(now.profile(std::vector<Position>{{101, 51.5}, {-259, 51.5}}, Metres{5}).length.value, 360);
  }
}

TEST(Longitudes, NumbersFarOutEndInAnAnswer) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(fractal(200, 100, 3, 500), {179, 52, 0.01, "EPSG:4326", 360}, folder);
  for (const double far : {1e6, 1e17, 1e200, 1.7e308}) {
    for (const double x : {far, -far}) {
      static_cast<void>(now.height(x, 51.5));
      static_cast<void>(is_inside(now, {x, 51.5}));
      EXPECT_NO_THROW(static_cast<void>(now.region({-far, 51.2, far, 51.8}).samples));
      try {
        static_cast<void>(now.region({x, 51.2, x + 1, 51.8}).samples);
      } catch (const Failure&) {
      }
      static_cast<void>(now.profile(std::vector<Position>{{x, 51.5}, {180, 51.5}, {-x / 2, 51}}, Metres{5}));
    }
  }
}

}  // namespace
}  // namespace talus
