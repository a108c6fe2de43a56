#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <gdal.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ingest/mosaic/source.hpp"
#include "talus/failure.hpp"
#include "talus/ingest.hpp"
#include "tests/support/inputs.hpp"
#include "tests/support/random.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"
#include "tests/support/tiles.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;
using support::all_codes;
using support::as_terrain;
using support::RasterOptions;
using support::SampleType;
using support::says;
using support::spelled;
using support::Terrain;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using MosaicTest = support::TilesTest;

TEST_F(MosaicTest, TheFirstInputsNorthWestSampleIsTheOrigin) {
  const fs::path east = constant("east.tif", 3, 2, 1, at(3, 1));
  const fs::path west = constant("west.tif", 3, 2, 2, at(0, 0));
  const Source source{{east, west}, {}};
  const Description& d = source.description();
  EXPECT_EQ(d.extent, (GridRect{{-3, -1}, {2, 1}}));
  EXPECT_EQ(d.mapping, (GridMapping{500035, 5199985, 10, -10}));
  EXPECT_EQ(d.source_name, "east.tif and 1 more");
  const auto all = all_codes(source);
  EXPECT_THAT(all.codes, ElementsAre(2, 2, 2, 0, 0, 0, 2, 2, 2, 1, 1, 1, 0, 0, 0, 1, 1, 1));
  EXPECT_THAT(all.valid, ElementsAre(1, 1, 1, 0, 0, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 1, 1, 1));
  EXPECT_TRUE(source.touches({{0, 0}, {0, 0}}));
  EXPECT_TRUE(source.touches({{-1, -1}, {0, 5}}));
  EXPECT_FALSE(source.touches({{0, -1}, {2, -1}}));
  EXPECT_EQ(source.inputs()[1].place, (GridRect{{-3, -1}, {-1, 0}}));
}

TEST_F(MosaicTest, TheLaterInputWinsAndAVoidCoversNothing) {
  Terrain upper = support::surface(3, 1, [](int col, int) { return 10 + col; });
  upper.make_void(1, 0);
  const fs::path a = constant("a.tif", 4, 1, 1, at(0, 0)), b = write("b.tif", upper, at(1, 0));
  EXPECT_THAT(all_codes(Source{{a, b}, {}}).codes, ElementsAre(1, 10, 1, 12));
  EXPECT_THAT(all_codes(Source{{b, a}, {}}).codes, ElementsAre(1, 1, 1, 1));
}

TEST_F(MosaicTest, EachInputHasItsOwnVoidValue) {
  Terrain left = support::surface(2, 1, [](int col, int) { return col == 0 ? -9999 : 5; });
  Terrain right = support::surface(2, 1, [](int col, int) { return col == 0 ? -32768 : 6; });
  left.make_void(0, 0), right.make_void(0, 0);
  RasterOptions one = at(0, 0), other = at(2, 0);
  one.nodata = -9999, other.nodata = -32768;
  const Source source{{write("a.tif", left, one), write("b.tif", right, other)}, {}};
  EXPECT_THAT(all_codes(source).valid, ElementsAre(0, 1, 0, 1));
  EXPECT_TRUE(says(source.notes(), "-32768 in one, -9999 in one"));
}

TEST_F(MosaicTest, SeamsAreComparedOnceHoweverWindowsOverlap) {
  Terrain a = support::surface(40, 30, [](int col, int row) { return col + row; });
  Terrain b = support::surface(40, 30, [](int col, int row) { return col + 35 + row; });
  b.at(2, 17) += 31;
  b.at(3, 20) -= 7;
  a.make_void(36, 3);
  const Source source{{write("a.tif", a, at(0, 0)), write("b.tif", b, at(35, 0))}, {}};
  for (int row = 0; row < 30; row += 10) {
    for (int col = 0; col < 75; col += 25) {
      const GridRect own{{col, row}, {col + 24, row + 9}};
      const GridRect part{{std::max(col - 6, 0), std::max(row - 6, 0)},
                          {std::min(col + 30, 74), std::min(row + 15, 29)}};
      static_cast<void>(source.read(part, own));
    }
  }
  static_cast<void>(source.read(source.description().extent));  // a look without own samples compares nothing
  const SeamReport seams = source.seams();
  EXPECT_EQ(seams.compared, 5u * 30u - 1u);
  EXPECT_EQ(seams.different, 2u);
  EXPECT_EQ(seams.largest_m, 31);
  EXPECT_EQ(seams.at, (GridPoint{37, 17}));
  EXPECT_EQ(seams.x, 500000 + 375);
  EXPECT_EQ(seams.y, 5200000 - 175);
  EXPECT_EQ(seams.covered, "a.tif");
  EXPECT_EQ(seams.covering, "b.tif");
}

TEST_F(MosaicTest, SeamDifferencesAreInMetres) {
  RasterOptions feet = at(0, 0);
  feet.unit = "ft";
  feet.scale = 0.5;
  const Source source{{constant("a.tif", 2, 2, 10, feet), constant("b.tif", 2, 2, 14, feet)}, {}};
  static_cast<void>(source.read(source.description().extent, source.description().extent));
  EXPECT_DOUBLE_EQ(source.seams().largest_m, 2 * 0.3048);
}

TEST_F(MosaicTest, SeamsAreOfTheVisibleSurface) {
  // Where the middle one is void, the top one meets the lowest.
  Terrain middle = support::surface(2, 1, [](int, int) { return 20; });
  middle.make_void(0, 0);
  const Source source{{constant("low.tif", 2, 1, 1, at(0, 0)), write("middle.tif", middle, at(0, 0)),
                       constant("top.tif", 2, 1, 50, at(0, 0))},
                      {}};
  static_cast<void>(source.read({{0, 0}, {1, 0}}, {{0, 0}, {1, 0}}));
  const SeamReport seams = source.seams();
  EXPECT_EQ(seams.compared, 3u);
  EXPECT_EQ(seams.largest_m, 49);
  EXPECT_EQ(seams.covered, "low.tif");
  EXPECT_EQ(seams.covering, "top.tif");
}

// ---- any arrangement, against a plain paste --------------------------------------------------------

TEST_F(MosaicTest, AnyArrangementEqualsAPlainPaste) {
  support::Random random(7);
  const auto below = [&](std::uint64_t n) { return random.next() % n; };
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(round);
    struct Tile {
      int col, row;
      Terrain terrain;
    };
    std::vector<Tile> tiles;
    std::vector<fs::path> files;
    const int count = 1 + static_cast<int>(below(6));
    const SampleType type = std::vector{SampleType::int16, SampleType::float32, SampleType::float64}[below(3)];
    for (int t = 0; t < count; ++t) {
      Tile tile{static_cast<int>(below(30)), static_cast<int>(below(30)),
                Terrain(1 + static_cast<int>(below(25)), 1 + static_cast<int>(below(25)))};
      for (std::size_t i = 0; i < tile.terrain.values.size(); ++i) {
        tile.terrain.values[i] = static_cast<double>(below(200));
        tile.terrain.valid[i] = t % 2 == 0 || below(4) != 0;
      }
      RasterOptions options = at(tile.col, tile.row, type);
      const bool south_up = below(2) == 0, mirrored = below(2) == 0;
      Terrain in_file = tile.terrain;
      for (int r = 0; r < in_file.rows; ++r) {
        for (int c = 0; c < in_file.cols; ++c) {
          const int from_c = mirrored ? in_file.cols - 1 - c : c, from_r = south_up ? in_file.rows - 1 - r : r;
          in_file.at(c, r) = tile.terrain.at(from_c, from_r);
          in_file.valid[in_file.index(c, r)] = tile.terrain.valid[tile.terrain.index(from_c, from_r)];
        }
      }
      auto& g = options.geotransform;
      if (mirrored) g[0] += 10 * in_file.cols, g[1] = -10;
      if (south_up) g[3] -= 10 * in_file.rows, g[5] = 10;
      files.push_back(write("t" + std::to_string(t) + ".tif", in_file, options));
      tiles.push_back(std::move(tile));
    }
    const Source source{files, {}};
    const GridRect extent = source.description().extent;
    const int first_col = tiles[0].col + extent.first.col, first_row = tiles[0].row + extent.first.row;
    Terrain expected(static_cast<int>(extent.cols()), static_cast<int>(extent.rows()));
    std::fill(expected.valid.begin(), expected.valid.end(), std::uint8_t{0});
    std::uint64_t compared = 0, different = 0;
    double largest = 0;
    for (const Tile& tile : tiles) {
      for (int r = 0; r < tile.terrain.rows; ++r) {
        for (int c = 0; c < tile.terrain.cols; ++c) {
          if (!tile.terrain.is_valid(c, r)) continue;
          const int col = tile.col + c - first_col, row = tile.row + r - first_row;
          const double value = tile.terrain.at(c, r);
          if (expected.is_valid(col, row)) {
            const double difference = std::abs(expected.at(col, row) - value);
            ++compared;
            different += difference != 0 ? 1 : 0;
            largest = std::max(largest, difference);
          }
          expected.at(col, row) = value;
          expected.valid[expected.index(col, row)] = 1;
        }
      }
    }
    const Terrain found = as_terrain(source);
    EXPECT_EQ(found.valid, expected.valid);
    EXPECT_EQ(found.values, expected.values);  // both 0 where void
    Window used;
    for (int i = 0; i < 10; ++i) {  // parts are parts of the whole
      const auto pick = [&](std::int32_t from, std::int64_t n) {
        return from + static_cast<std::int32_t>(below(static_cast<std::uint64_t>(n)));
      };
      GridRect part{{pick(extent.first.col, extent.cols()), pick(extent.first.row, extent.rows())}, {}};
      part.last = {pick(part.first.col, extent.last.col - part.first.col + 1),
                   pick(part.first.row, extent.last.row - part.first.row + 1)};
      source.read_into(used, part, {{0, 0}, {-1, -1}});
      const auto all = spelled(used);
      std::size_t at_sample = 0;
      for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
        for (std::int32_t col = part.first.col; col <= part.last.col; ++col, ++at_sample) {
          const int c = col - extent.first.col, r = row - extent.first.row;
          ASSERT_EQ(all.valid[at_sample] != 0, expected.is_valid(c, r));
          ASSERT_EQ(all.codes[at_sample], expected.at(c, r));
        }
      }
    }
    const std::int32_t middle = static_cast<std::int32_t>(extent.first.row + extent.rows() / 2);
    const GridRect upper{extent.first, {extent.last.col, middle}}, lower{{extent.first.col, middle + 1}, extent.last};
    const Source other = source.clone();
    static_cast<void>(source.read(extent, upper));
    static_cast<void>(other.read(extent, lower));
    const SeamReport seams = joined(source.seams(), other.seams());
    EXPECT_EQ(seams.compared, compared);
    EXPECT_EQ(seams.different, different);
    EXPECT_EQ(seams.largest_m, largest);
  }
}

// ---- what goes together ----------------------------------------------------------------------------

TEST_F(MosaicTest, TypesMeetInTheNarrowestThatHoldsAll) {
  const auto step_and_type = [&](SampleType a, SampleType b) {
    const Source source{{constant("a.tif", 2, 2, 7, at(0, 0, a)), constant("b.tif", 2, 2, 9, at(2, 0, b))}, {}};
    EXPECT_THAT(all_codes(source).codes, ElementsAre(7, 7, 9, 9, 7, 7, 9, 9));
    const Window window = source.read(source.description().extent);
    EXPECT_TRUE(window.valid.empty());
    return std::pair{source.description().step.integer, window.codes.index()};
  };
  using enum SampleType;
  EXPECT_EQ(step_and_type(uint8, int16), std::pair(true, std::size_t{0}));
  EXPECT_EQ(step_and_type(int16, uint16), std::pair(true, std::size_t{1}));
  EXPECT_EQ(step_and_type(int16, int32), std::pair(true, std::size_t{2}));
  EXPECT_EQ(step_and_type(uint32, uint8), std::pair(true, std::size_t{2}));
  EXPECT_EQ(step_and_type(int16, float32), std::pair(false, std::size_t{1}));
  EXPECT_EQ(step_and_type(float32, uint16), std::pair(false, std::size_t{1}));
  EXPECT_EQ(step_and_type(int32, float32), std::pair(false, std::size_t{2}));
  EXPECT_EQ(step_and_type(float64, int16), std::pair(false, std::size_t{2}));
}

TEST_F(MosaicTest, DifferentScalesMeetAsValues) {
  RasterOptions tenths = at(0, 0), whole = at(1, 0);
  tenths.scale = 0.1;
  const Source source{{constant("a.tif", 1, 1, 123, tenths), constant("b.tif", 1, 1, 12, whole)}, {}};
  EXPECT_EQ(source.description().step, (HeightStep{1, 1, 0, false}));
  EXPECT_THAT(all_codes(source).codes, ElementsAre(123 * 0.1, 12));
}

TEST_F(MosaicTest, AForcedStepRoundsToWholeCodes) {
  InputOptions options;
  options.height_step = Metres{0.5};
  const Terrain heights = support::surface(4, 1, [](int col, int) { return 100.2 + 0.25 * col; });
  const Source source{{write("a.tif", heights, at(0, 0, SampleType::float64))}, options};
  EXPECT_EQ(source.description().step, (HeightStep{1, 2, 0, true}));
  EXPECT_THAT(all_codes(source).codes, ElementsAre(200, 201, 201, 202));  // 100.2 100.45 100.7 100.95
  const Raster raster{{folder_ / "a.tif"}, options};
  EXPECT_THAT(raster.read({{0, 0}, {3, 0}}).values, ElementsAre(100, 100.5, 100.5, 101));

  options.height_step = Metres{10};
  EXPECT_THAT(all_codes(Source{{constant("b.tif", 2, 1, 126, at(0, 0))}, options}).codes, ElementsAre(13, 13));
  for (const double bad : {-1.0, 1e-9, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    options.height_step = Metres{bad};
    EXPECT_EQ(failure_with({folder_ / "a.tif"}, options).cause(), Cause::invalid_argument) << bad;
  }
}

TEST_F(MosaicTest, WithSmallerCellsOnTopOrderDoesNotMatter) {
  RasterOptions coarse = at(0, 0);
  coarse.geotransform = {500000, 20, 0, 5200000, 0, -20};
  const fs::path fine = constant("fine.tif", 4, 4, 1, at(0, 0)), rough = constant("rough.tif", 4, 4, 2, coarse);
  InputOptions options;
  options.resampling = Resampling::near;
  EXPECT_EQ(all_codes(Source{{fine, rough}, options}).codes[0], 2);
  options.priority_resolution = true;
  const auto all = all_codes(Source{{fine, rough}, options});
  EXPECT_EQ(all.codes[0], 1);
  EXPECT_EQ(all.codes[7], 2);
}

TEST_F(MosaicTest, TilesThatDoNotFitSayWhatWould) {
  const fs::path a = constant("a.tif", 3, 3, 1, at(0, 0));
  RasterOptions other = at(3, 0);
  other.geotransform[0] += 3;
  const Failure shifted = failure_with({a, constant("b.tif", 3, 3, 1, other)});
  EXPECT_EQ(shifted.cause(), Cause::unsupported);
  EXPECT_THAT(shifted.what(),
              AllOf(HasSubstr("b.tif"), HasSubstr("on one grid"), HasSubstr("InputOptions::target_dx")));
  other = at(3, 0);
  other.geotransform[1] = 10.01;
  EXPECT_THAT(failure_with({a, constant("b.tif", 3, 3, 1, other)}).what(), HasSubstr("10.01"));
  other = at(3, 0);
  other.crs = "EPSG:25833";
  EXPECT_THAT(failure_with({a, constant("b.tif", 3, 3, 1, other)}).what(),
              AllOf(HasSubstr("another coordinate system"), HasSubstr("InputOptions::target_srs")));
  other.crs = "";
  EXPECT_THAT(failure_with({a, constant("b.tif", 3, 3, 1, other)}).what(),
              AllOf(HasSubstr("b.tif"), HasSubstr("no coordinate system"), HasSubstr("InputOptions::srs")));
  InputOptions options;
  options.srs = "EPSG:25832";
  EXPECT_EQ((Source{{a, folder_ / "b.tif"}, options}.description().extent), (GridRect{{0, 0}, {5, 2}}));
  other = at(3, 0);
  other.unit = "ft";
  EXPECT_THAT(failure_with({a, constant("b.tif", 3, 3, 1, other)}).what(),
              AllOf(HasSubstr("b.tif"), HasSubstr("ft"), HasSubstr("InputOptions::vertical_unit")));
  other = at(3, 0);
  other.geotransform[2] = 1;
  EXPECT_THAT(failure_with({a, constant("b.tif", 3, 3, 1, other)}).what(),
              AllOf(HasSubstr("b.tif"), HasSubstr("rotated"), HasSubstr("InputOptions::target_srs")));
  other.geotransform = {0, 1, 0, 0, 0, 1};
  EXPECT_THAT(failure_with({a, constant("b.tif", 3, 3, 1, other)}).what(),
              AllOf(HasSubstr("b.tif"), HasSubstr("no position")));
}

TEST_F(MosaicTest, SmallDriftIsTheSameGrid) {
  RasterOptions other = at(3, 0);
  other.geotransform[0] += 0.005;
  other.geotransform[1] += 1e-6;
  EXPECT_EQ(
      (Source{{constant("a.tif", 3, 3, 1, at(0, 0)), constant("b.tif", 3, 3, 1, other)}, {}}.description().extent),
      (GridRect{{0, 0}, {5, 2}}));
}

TEST_F(MosaicTest, TilesFarApartAreRefusedBeforeAnythingIsAllocated) {
  RasterOptions far = at(0, 0);
  far.geotransform[0] += 1e12;
  const Failure failure = failure_with({constant("a.tif", 3, 3, 1, at(0, 0)), constant("b.tif", 3, 3, 1, far)});
  EXPECT_EQ(failure.cause(), Cause::invalid_argument);
  EXPECT_THAT(failure.what(), HasSubstr("at most"));
  far.geotransform[0] = 500000 + 2e9, far.geotransform[3] -= 2e9;
  EXPECT_THAT(failure_with({folder_ / "a.tif", constant("b.tif", 3, 3, 1, far)}).what(), HasSubstr("1 more have"));
}

TEST_F(MosaicTest, AHugeVirtualRasterIsRefused) {
  const fs::path vrt = write_text("huge.vrt", R"(<VRTDataset rasterXSize="1000000000" rasterYSize="1000000000">
    <VRTRasterBand dataType="Int16" band="1"/></VRTDataset>)");
  const Failure failure = failure_with({vrt});
  EXPECT_EQ(failure.cause(), Cause::invalid_argument);
  EXPECT_THAT(failure.what(), AllOf(HasSubstr("huge.vrt"), HasSubstr("1000000000 x 1000000000")));
}

TEST_F(MosaicTest, UnitsComeFromTheBandTheCrsOrTheOption) {
  RasterOptions options = at(0, 0);
  options.crs = "EPSG:25832+6360";  // NAVD88 in US survey feet
  const fs::path file = constant("a.tif", 2, 2, 1, options);
  EXPECT_EQ((Source{{file}, {}}.description().metres_per_unit), 1200.0 / 3937);
  options.crs = "EPSG:25832";
  const fs::path silent = constant("b.tif", 2, 2, 1, options);
  const Source assumed{{silent}, {}};
  EXPECT_EQ(assumed.description().metres_per_unit, 1);
  EXPECT_TRUE(says(assumed.notes(), "no vertical unit"));
  InputOptions said;
  said.vertical_unit = VerticalUnit::foot;
  EXPECT_EQ((Source{{silent}, said}.description().metres_per_unit), 0.3048);
  options.unit = "m";
  EXPECT_TRUE(says(Source{{constant("c.tif", 2, 2, 1, options)}, said}.notes(), "InputOptions::vertical_unit"));
}

TEST_F(MosaicTest, AnSrsThatOverrulesIsNoted) {
  InputOptions options;
  options.srs = "EPSG:25833";
  const Source source{{constant("a.tif", 2, 2, 1, at(0, 0))}, options};
  EXPECT_THAT(source.description().crs_wkt, HasSubstr("UTM zone 33N"));
  EXPECT_TRUE(says(source.notes(), "InputOptions::srs"));
  options.srs = "EPSG:nowhere";
  EXPECT_EQ(failure_with({folder_ / "a.tif"}, options).cause(), Cause::invalid_argument);
  for (const std::string& elsewhere : {(folder_ / "a.tif").string(), std::string("http://localhost/crs")}) {
    options.srs = elsewhere;
    EXPECT_EQ(failure_with({folder_ / "a.tif"}, options).cause(), Cause::invalid_argument) << elsewhere;
  }
}

TEST_F(MosaicTest, AVoidValueThatTheTypeCannotHoldIsNoted) {
  const fs::path tile = constant("a.tif", 2, 2, 1, at(0, 0, SampleType::uint8));
  const fs::path vrt = write_text("v.vrt", R"(<VRTDataset rasterXSize="2" rasterYSize="2">
    <VRTRasterBand dataType="Byte" band="1"><NoDataValue>-9999</NoDataValue><SimpleSource>
    <SourceFilename relativeToVRT="1">a.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>)");
  const Source source{{vrt}, {}};
  EXPECT_TRUE(source.read(source.description().extent).valid.empty());
  EXPECT_TRUE(says(source.notes(), "the void value -9999"));
}

// ---- the antimeridian ------------------------------------------------------------------------------

TEST_F(MosaicTest, TilesOnBothSidesOfTheAntimeridianAreNeighbours) {
  const auto tile = [](double west, double cell = 0.5) {
    RasterOptions options;
    options.crs = "EPSG:4326";
    options.geotransform = {west, cell, 0, 10, 0, -cell};
    return options;
  };
  const fs::path east = constant("e.tif", 4, 2, 1, tile(178)), west = constant("w.tif", 4, 2, 2, tile(-180));
  const Source source{{east, west}, {}};
  EXPECT_EQ(source.description().extent, (GridRect{{0, 0}, {7, 1}}));
  EXPECT_THAT(all_codes(source).codes, ElementsAre(1, 1, 1, 1, 2, 2, 2, 2, 1, 1, 1, 1, 2, 2, 2, 2));
  EXPECT_TRUE(says(source.notes(), "antimeridian"));
  const Source from_the_west{{west, east}, {}};
  EXPECT_EQ(from_the_west.description().extent, (GridRect{{-4, 0}, {3, 1}}));

  const fs::path apart = constant("a.tif", 4, 2, 2, tile(-170));
  EXPECT_EQ((Source{{east, apart}, {}}.description().extent.cols()), 2 * 348 + 4);  // they do not touch
  const fs::path beyond = constant("b.tif", 4, 2, 3, tile(180));
  EXPECT_EQ((Source{{east, beyond}, {}}.description().extent), (GridRect{{0, 0}, {7, 1}}));
  EXPECT_FALSE(says(Source{{east, beyond}, {}}.notes(), "antimeridian"));

  InputOptions options;
  options.grid = grid_of(Source{{east}, {}}.description());
  EXPECT_EQ((Source{{west}, options}.description().extent), (GridRect{{4, 0}, {7, 1}}));
}

// ---- real tiles ------------------------------------------------------------------------------------

/// Lays files one over the other through GDAL alone; every tile has 1201 samples a side of 3 arc seconds.
Terrain plain_paste(const std::vector<fs::path>& files, GridPoint size, double west, double north) {
  Terrain all(size.col, size.row);
  std::fill(all.valid.begin(), all.valid.end(), std::uint8_t{0});
  for (const fs::path& file : files) {
    GDALDatasetH dataset = GDALOpen(file.c_str(), GA_ReadOnly);
    if (dataset == nullptr) continue;
    double t[6];
    if (GDALGetGeoTransform(dataset, t) != CE_None) ADD_FAILURE() << file;
    GDALClose(dataset);
    const Terrain tile = support::read_raster(file);
    const int col = static_cast<int>(std::lround((t[0] - west) * 1200)),
              row = static_cast<int>(std::lround((north - t[3]) * 1200));
    for (int r = 0; r < tile.rows; ++r) {
      for (int c = 0; c < tile.cols; ++c) {
        if (!tile.is_valid(c, r)) continue;
        all.at(col + c, row + r) = tile.at(c, r);
        all.valid[all.index(col + c, row + r)] = 1;
      }
    }
  }
  return all;
}

std::vector<fs::path> tiles_of(const std::string& folder) {
  const char* dem = std::getenv("TALUS_DEM_DIR");
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::path(dem == nullptr ? "../shared/dem" : dem) / folder, error)) {
    if (entry.path().extension() == ".tif") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST_F(MosaicTest, RealTilesWithConflictsEqualAPlainPaste) {
  constexpr double kHalf = 0.5 / 1200;
  for (const auto& [folder, size, west, north, largest] :
       {std::tuple("puget_3s", GridPoint{4801, 3601}, -124 - kHalf, 50 + kHalf, 24.0),
        std::tuple("swiss_germany_3s", GridPoint{3601, 3601}, 7 - kHalf, 50 + kHalf, 0.0)}) {
    SCOPED_TRACE(folder);
    const std::vector<fs::path> files = tiles_of(folder);
    if (files.empty()) GTEST_SKIP() << "no " << folder << " in TALUS_DEM_DIR";
    const Source source{files, {}}, of_folder{{files.front().parent_path()}, {}};
    const GridRect extent = source.description().extent;
    EXPECT_EQ(of_folder.description().extent, extent);
    const Terrain expected = plain_paste(files, size, west, north);
    ASSERT_EQ(extent.cols(), expected.cols);
    ASSERT_EQ(extent.rows(), expected.rows);
    Window window;
    source.read_into(window, extent, extent);
    ASSERT_TRUE(std::holds_alternative<std::vector<std::int16_t>>(window.codes));
    const auto& codes = std::get<std::vector<std::int16_t>>(window.codes);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const bool data = window.valid.empty() || window.valid[i] != 0;
      if (data != (expected.valid[i] != 0) || (data && codes[i] != expected.values[i])) ++wrong;
    }
    EXPECT_EQ(wrong, 0u);
    if (largest > 0) {
      EXPECT_EQ(source.seams().largest_m, largest);
    }
    EXPECT_EQ(of_folder.read(extent).codes, window.codes);
  }
}

TEST_F(MosaicTest, RealTilesAndTheirVirtualRasterAgree) {
  std::vector<fs::path> files = tiles_of("swiss_germany_3s");
  if (files.empty()) GTEST_SKIP() << "no swiss_germany_3s in TALUS_DEM_DIR";
  const Source virtual_one{{files.front().parent_path() / "swiss_germany.vrt"}, {}};
  std::rotate(files.begin(), files.end() - 3, files.end());  // the north-west tile first: the same origin
  const Source mosaic{files, {}};
  ASSERT_EQ(mosaic.description().extent, virtual_one.description().extent);
  const auto a = all_codes(mosaic), b = all_codes(virtual_one);
  EXPECT_EQ(a.valid, b.valid);
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.codes.size(); ++i) different += a.valid[i] != 0 && a.codes[i] != b.codes[i];
  EXPECT_EQ(different, 0u);
}

}  // namespace
}  // namespace talus
