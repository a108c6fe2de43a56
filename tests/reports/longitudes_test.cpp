// Reports of places near the antimeridian: longitudes that are a full turn apart are the same.

#include "talus/talus.hpp"
#include "tests/reports/report.hpp"

namespace talus::support {
namespace {

class Longitudes : public Report {
 protected:
  /// 100 x 100 cells of 0.01°, west and north edges named.
  void write_tile(const std::string& name, double west, double base) const {
    Band band;
    for (int row = 0; row < 100; ++row) {
      for (int col = 0; col < 100; ++col) band.samples.push_back(base + col + row);
    }
    write_bands(folder / name, 100, 100, {band},
                {.type = GDT_Int16, .crs = "EPSG:4326", .geotransform = {{west, 0.01, 0, 52, 0, -0.01}}});
  }
  /// Cells of a degree from 0 to 360, all of one height.
  void write_globe(const std::string& name, double west, double height) const {
    Band band;
    band.samples.assign(360 * 10, height);
    write_bands(folder / name, 360, 10, {band},
                {.type = GDT_Int16, .crs = "EPSG:4326", .geotransform = {{west, 1, 0, 5, 0, -1}}});
  }
  void write_part(const std::string& name, double west, int cols, double height) const {
    Band band;
    band.samples.assign(static_cast<std::size_t>(cols) * 10, height);
    write_bands(folder / name, cols, 10, {band},
                {.type = GDT_Int16, .crs = "EPSG:4326", .geotransform = {{west, 1, 0, 5, 0, -1}}});
  }
  [[nodiscard]] std::string height(double x, double y) const {
    return talus({"height", "d.talus", std::to_string(x), std::to_string(y)}).out;
  }
};

// ACCESS-Cloud-Based-InSAR/dem-stitcher#47: the two sides of the antimeridian, in whatever order.
TEST_F(Longitudes, TilesOnBothSidesOfTheAntimeridianAreOneWhateverTheOrder) {
  write_tile("west.tif", 179, 1000);
  write_tile("east.tif", -180, 3000);
  for (const auto& how : std::vector<std::vector<std::vector<std::string>>>{
           {{"west.tif", "east.tif", "d.talus"}},
           {{"east.tif", "west.tif", "d.talus"}},
           {{"west.tif", "d.talus"}, {"east.tif", "d.talus", "--update"}},
           {{"east.tif", "d.talus"}, {"west.tif", "d.talus", "--update"}}}) {
    for (std::size_t i = 0; i < how.size(); ++i) {
      std::vector<std::string> words = how[i];
      words.insert(words.begin(), "ingest");
      if (i == 0) words.push_back("--overwrite");
      const Outcome outcome = talus(words);
      ASSERT_EQ(outcome.exit_code, done) << outcome.err;
    }
    SCOPED_TRACE(::testing::PrintToString(how));
    EXPECT_EQ(json_of(talus({"info", "d.talus", "--json"})).at("cols"), 200);
    for (const double turn : {-360.0, 0.0, 360.0}) {
      EXPECT_EQ(height(179.505 + turn, 51.495), "1100\n");
      EXPECT_EQ(height(-179.495 + turn, 51.495), "3100\n");
    }
  }
}

// tilezen/joerd#164 and others count from 0 to 360 and from −180 to 180.
TEST_F(Longitudes, APartOfTheGlobeLandsWhereItBelongsWhicheverWayItIsWritten) {
  write_globe("globe.tif", 0, 10);
  write_part("part.tif", -20, 15, 500);  // 340 to 355
  write_part("across.tif", -3, 6, 700);  // 357 to 363: both ends of the globe
  for (const auto& how : std::vector<std::vector<std::vector<std::string>>>{
           {{"globe.tif", "part.tif", "across.tif", "d.talus"}},
           {{"globe.tif", "d.talus"}, {"part.tif", "across.tif", "d.talus", "--update"}}}) {
    for (std::size_t i = 0; i < how.size(); ++i) {
      std::vector<std::string> words = how[i];
      words.insert(words.begin(), "ingest");
      if (i == 0) words.push_back("--overwrite");
      const Outcome outcome = talus(words);
      ASSERT_EQ(outcome.exit_code, done) << outcome.err;
    }
    const Snapshot now = Database::open(folder / "d.talus").snapshot();
    const SampleWindow window = now.samples(now.description().extent);
    ASSERT_EQ(window.region.cols(), 360);
    for (int col = 0; col < 360; ++col) {
      const double expected = col >= 340 && col < 355 ? 500 : col >= 357 || col < 3 ? 700 : 10;
      ASSERT_EQ(window.values[static_cast<std::size_t>(col)], expected) << col;
      ASSERT_NE(window.valid[static_cast<std::size_t>(col)], 0);
    }
  }
}

TEST_F(Longitudes, AGlobeLaidOverAPartKeepsThePartsLongitudes) {
  write_globe("globe.tif", 0, 10);
  write_part("part.tif", -20, 15, 500);
  const Outcome outcome = talus({"ingest", "part.tif", "globe.tif", "d.talus"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  const Snapshot now = Database::open(folder / "d.talus").snapshot();
  const SampleWindow window = now.samples(now.description().extent);
  EXPECT_EQ(window.region.cols(), 360);
  EXPECT_EQ(now.description().mapping.x(now.description().extent.first.col), -19.5);
  for (const double value : window.values) ASSERT_EQ(value, 10);  // the globe is on top
}

// A raster that repeats its first column at its end stays as it is.
TEST_F(Longitudes, AGlobeOfOneColumnMoreStaysAsItIs) {
  write_part("lines.tif", -180.5, 361, 20);
  const Outcome outcome = talus({"ingest", "lines.tif", "d.talus"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_EQ(json_of(talus({"info", "d.talus", "--json"})).at("cols"), 361);
}

// Resampled tiles are joined across it, too.
TEST_F(Longitudes, ResampledTilesMeetAtTheAntimeridian) {
  Band west, east;
  for (int row = 0; row < 100; ++row) {
    for (int col = 0; col < 100; ++col) {
      west.samples.push_back(1000 + 3 * col + row);
      east.samples.push_back(1300 + 3 * col + row);
    }
  }
  write_bands(folder / "west.tif", 100, 100, {west},
              {.crs = "EPSG:4326", .geotransform = {{179, 0.01, 0, 52, 0, -0.01}}});
  write_bands(folder / "east.tif", 100, 100, {east},
              {.crs = "EPSG:4326", .geotransform = {{-180, 0.01, 0, 52, 0, -0.01}}});
  const Outcome outcome = talus({"ingest", "west.tif", "east.tif", "d.talus", "--tr", "0.004,0.004"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  const Cells cells = cells_of_database(folder / "d.talus");
  EXPECT_EQ(cells.cols, 500);
  for (int col = 200; col < 300; ++col) {  // half a cell on both sides of the joint would be flat, were they apart
    const double step = *cells.at(col + 1, 100) - *cells.at(col, 100);
    ASSERT_NEAR(step, 1.2, 1e-3) << col;
  }
}

}  // namespace
}  // namespace talus::support
