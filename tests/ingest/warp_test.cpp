#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ingest/mosaic/source.hpp"
#include "talus/failure.hpp"
#include "talus/ingest.hpp"
#include "tests/support/inputs.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;
using support::all_codes;
using support::as_terrain;
using support::failure_of;
using support::RasterOptions;
using support::SampleType;
using support::says;
using support::TempFolder;
using support::Terrain;
using support::write_raster;
using ::testing::AllOf;
using ::testing::HasSubstr;

class WarpTest : public ::testing::Test {
 protected:
  static RasterOptions utm(double x, double y, double cell = 10, SampleType type = SampleType::int16) {
    RasterOptions options;
    options.type = type;
    options.crs = "EPSG:25832";
    options.geotransform = {x, cell, 0, y, 0, -cell};
    return options;
  }
  fs::path write(const std::string& name, const Terrain& terrain, const RasterOptions& options) {
    write_raster(terrain, folder_ / name, options);
    return folder_ / name;
  }
  /// A plane in the CRS's own coordinates, which bilinear and cubic resampling to smaller cells keep.
  static double plane_at(double x, double y) { return 300 + (x - 500000) / 16 + (y - 5200000) / 32; }
  fs::path plane(const std::string& name, int cols, int rows, const RasterOptions& o) {
    const auto& g = o.geotransform;
    return write(
        name,
        support::surface(cols, rows,
                         [&](int c, int r) { return plane_at(g[0] + (c + 0.5) * g[1], g[3] + (r + 0.5) * g[5]); }),
        o);
  }
  TempFolder folder_;
};

TEST_F(WarpTest, APlaneStaysAPlaneInSmallerCells) {
  const fs::path file = plane("p.tif", 64, 64, utm(500000, 5200000, 16, SampleType::float64));
  for (const Resampling method : {Resampling::bilinear, Resampling::cubic}) {
    for (const auto& [dx, dy] : {std::pair(7.0, 5.0), std::pair(16.0, 14.0), std::pair(16.0, 16.0)}) {
      SCOPED_TRACE(name_of(method));
      InputOptions options;
      options.target_dx = dx, options.target_dy = dy;
      options.resampling = method;
      const Source source{{file}, options};
      const Description& d = source.description();
      EXPECT_EQ(d.mapping.dx, dx);
      EXPECT_EQ(d.mapping.dy, -dy);
      EXPECT_EQ(d.extent.first, (GridPoint{0, 0}));
      EXPECT_EQ(d.source_type, "Float64");
      const Terrain found = as_terrain(source);
      for (int r = 2; r < found.rows - 2; ++r) {
        for (int c = 2; c < found.cols - 2; ++c) {
          const double x = d.mapping.x(c), y = d.mapping.y(r);
          if (x < 500040 || x > 500984 || y > 5199960 || y < 5199016) continue;  // two cells inside
          ASSERT_TRUE(found.is_valid(c, r));
          ASSERT_NEAR(found.at(c, r), plane_at(x, y), 1e-6) << c << ' ' << r;
        }
      }
    }
  }
}

TEST_F(WarpTest, CellsOfAGivenSizeBeginAtMultiplesOfIt) {
  InputOptions options;
  options.target_dx = options.target_dy = 25;
  const Source source{{plane("p.tif", 50, 50, utm(500003, 5200001))}, options};
  const GridMapping& m = source.description().mapping;
  EXPECT_EQ(std::remainder(m.x0 - 12.5, 25), 0);
  EXPECT_EQ(std::remainder(m.y0 - 12.5, 25), 0);
  EXPECT_EQ(source.description().source_type, "Float32");
  EXPECT_TRUE(says(source.notes(), "resampled"));
  EXPECT_TRUE(source.inputs()[0].is_resampled);
}

TEST_F(WarpTest, EveryWindowSeesTheSameSamples) {
  Terrain terrain = support::sine_hills(300, 260);
  for (int i = 0; i < 200; ++i) terrain.make_void(60 + i % 20, 40 + i / 20);
  RasterOptions options = utm(500000, 5200000, 30, SampleType::float32);
  options.nodata = -9999;
  const fs::path file = write("h.tif", support::fit(terrain, SampleType::float32), options);
  for (const Resampling method : {Resampling::near, Resampling::bilinear, Resampling::cubic, Resampling::average}) {
    SCOPED_TRACE(name_of(method));
    InputOptions target;
    target.target_srs = "EPSG:4326";
    target.target_dx = target.target_dy = 0.0004;
    target.resampling = method;
    const Source whole{{file}, target}, parts{{file}, target};
    const Terrain expected = as_terrain(whole);
    EXPECT_TRUE(expected.has_voids());
    const GridRect extent = parts.description().extent;
    for (std::int32_t row = extent.last.row; row >= extent.first.row; row -= 37) {
      for (std::int32_t col = extent.first.col; col <= extent.last.col; col += 41) {
        const GridRect part{{col, std::max(row - 50, extent.first.row)}, {std::min(col + 60, extent.last.col), row}};
        const auto found = support::spelled(parts.read(part));
        std::size_t i = 0;
        for (std::int32_t r = part.first.row; r <= part.last.row; ++r) {
          for (std::int32_t c = part.first.col; c <= part.last.col; ++c, ++i) {
            ASSERT_EQ(found.valid[i] != 0, expected.is_valid(c - extent.first.col, r - extent.first.row));
            ASSERT_EQ(found.codes[i], expected.at(c - extent.first.col, r - extent.first.row));
          }
        }
      }
    }
  }
}

TEST_F(WarpTest, VoidsNeverLeakIntoHeights) {
  for (const SampleType type : {SampleType::int16, SampleType::float32, SampleType::float64}) {
    Terrain terrain = support::surface(40, 40, [](int, int) { return 700; });
    for (int r = 10; r < 20; ++r) {
      for (int c = 5; c < 25; ++c) terrain.make_void(c, r);
    }
    for (const double nodata : {-9999.0, std::numeric_limits<double>::quiet_NaN()}) {
      if (type == SampleType::int16 && std::isnan(nodata)) continue;
      RasterOptions options = utm(500000, 5200000, 10, type);
      options.nodata = nodata;
      const fs::path file = write("v.tif", terrain, options);
      for (const Resampling method : {Resampling::near, Resampling::bilinear, Resampling::cubic, Resampling::average}) {
        SCOPED_TRACE(name_of(method));
        InputOptions target;
        target.target_dx = target.target_dy = 6;
        target.resampling = method;
        const Terrain found = as_terrain(Source{{file}, target});
        EXPECT_TRUE(found.has_voids());
        for (std::size_t i = 0; i < found.values.size(); ++i) {
          if (found.valid[i] != 0) {
            ASSERT_NEAR(found.values[i], 700, 1e-3);
          }
        }
      }
    }
  }
}

TEST_F(WarpTest, NearestNeighboursKeepTypeAndCodes) {
  RasterOptions options = utm(500003, 5200000);
  options.scale = 0.1;
  InputOptions target;
  target.target_dx = target.target_dy = 5;
  target.resampling = Resampling::near;
  const Source source{{write("n.tif", support::surface(20, 20, [](int c, int r) { return 100 * c + r; }), options)},
                      target};
  EXPECT_EQ(source.description().step, (HeightStep{0.1, 1, 0, true}));
  EXPECT_TRUE(std::holds_alternative<std::vector<std::int16_t>>(source.read(source.description().extent).codes));
}

TEST_F(WarpTest, TilesOfTwoZonesJoinOnOneGrid) {
  // The same hill seen from two zones, resampled to a third CRS: what both cover agrees to interpolation.
  RasterOptions east = utm(250000, 5300000, 50, SampleType::float32);
  east.crs = "EPSG:25833";
  const auto hill = [](int c, int r) { return 1000 + 0.001 * (c - 100) * (c - 100) + 0.001 * (r - 100) * (r - 100); };
  const fs::path a = write("a.tif", support::surface(200, 200, hill), utm(700000, 5300000, 50, SampleType::float32));
  const fs::path b = write("b.tif", support::surface(200, 200, hill), east);
  EXPECT_EQ(failure_of([&] { Source{{a, b}, {}}; }).cause(), Cause::unsupported);
  InputOptions target;
  target.target_srs = "EPSG:3035";
  target.target_dx = target.target_dy = 50;
  const Source source{{a, b}, target};
  EXPECT_THAT(source.description().crs_wkt, HasSubstr("LAEA"));
  EXPECT_TRUE(as_terrain(source).has_data());
  EXPECT_NEAR(source.description().mapping.dx, 50, 0);
}

TEST_F(WarpTest, AnExistingGridIsAdopted) {
  const fs::path first = plane("first.tif", 40, 40, utm(500000, 5200000, 10, SampleType::float32));
  const fs::path aligned = plane("aligned.tif", 20, 20, utm(499900, 5200000, 10, SampleType::float32));
  const fs::path crooked = plane("crooked.tif", 30, 30, utm(500403, 5200000, 10, SampleType::float32));
  InputOptions options;
  options.grid = grid_of(Source{{first}, {}}.description());
  const Source same{{aligned}, options};
  EXPECT_EQ(same.description().extent, (GridRect{{-10, 0}, {9, 19}}));
  EXPECT_EQ(same.description().mapping, options.grid->mapping);
  EXPECT_FALSE(same.inputs()[0].is_resampled);
  const Source other{{crooked}, options};
  EXPECT_TRUE(other.inputs()[0].is_resampled);
  EXPECT_EQ(other.description().mapping, options.grid->mapping);
  EXPECT_EQ(other.description().extent.first.col, 40);

  // A database in whole numbers cannot take floats in between.
  options.grid->step = HeightStep{1, 1, 0, true};
  const Failure failure = failure_of([&] { Source{{aligned}, options}; });
  EXPECT_EQ(failure.cause(), Cause::unsupported);
  EXPECT_THAT(failure.what(), HasSubstr("whole"));
  options.grid->step.reset();
  options.grid->metres_per_unit = 0.3048;
  EXPECT_EQ(failure_of([&] { Source{{aligned}, options}; }).cause(), Cause::unsupported);
}

TEST_F(WarpTest, ARotatedRasterIsTurnedOnRequestOnly) {
  RasterOptions options = utm(500000, 5200000, 10, SampleType::float32);
  options.geotransform = {500000, 8, 6, 5200000, 6, -8};
  const fs::path file = write("r.tif", support::surface(50, 50, [](int, int) { return 5; }), options);
  EXPECT_THAT(failure_of([&] {
                Source{{file}, {}};
              }).what(),
              AllOf(HasSubstr("rotated"), HasSubstr("InputOptions::target_dx")));
  InputOptions target;
  target.target_dx = target.target_dy = 10;
  const Terrain found = as_terrain(Source{{file}, target});
  EXPECT_EQ(found.at(found.cols / 2, found.rows / 2), 5);
  EXPECT_FALSE(found.is_valid(0, 0));
}

TEST_F(WarpTest, HeightsAreNeverChanged) {
  RasterOptions options = utm(500000, 5200000, 10, SampleType::float32);
  options.crs = "EPSG:25832+5783";
  const fs::path file = plane("p.tif", 40, 40, options);
  InputOptions target;
  target.target_srs = "EPSG:25833+5783";
  const Source same{{file}, target};
  EXPECT_THAT(same.description().crs_wkt, HasSubstr("COMPOUNDCRS"));
  target.target_srs = "EPSG:25833";  // keeps what heights count from
  const Source kept{{file}, target};
  EXPECT_THAT(kept.description().crs_wkt, AllOf(HasSubstr("zone 33N"), HasSubstr("DHHN92")));
  for (const char* other : {"EPSG:25833+5773", "EPSG:4979"}) {
    target.target_srs = other;
    const Failure failure = failure_of([&] { Source{{file}, target}; });
    EXPECT_EQ(failure.cause(), Cause::unsupported);
    EXPECT_THAT(failure.what(), HasSubstr("heights"));
  }
  options.crs = "EPSG:25832+5773";
  target = {};
  target.resampling = Resampling::near;
  EXPECT_THAT(failure_of([&] { Source{{file, plane("q.tif", 40, 40, options)}, target}; }).what(), HasSubstr("q.tif"));
}

TEST_F(WarpTest, OptionsThatMakeNoSenseAreRefused) {
  const fs::path file = plane("p.tif", 40, 40, utm(500000, 5200000));
  const auto cause = [&](auto&& set) {
    InputOptions options;
    set(options);
    return failure_of([&] { Source{{file}, options}; }).cause();
  };
  EXPECT_EQ(cause([](InputOptions& o) { o.target_srs = "EPSG:x"; }), Cause::invalid_argument);
  EXPECT_EQ(cause([](InputOptions& o) { o.target_dx = 10; }), Cause::invalid_argument);
  EXPECT_EQ(cause([](InputOptions& o) { o.target_dx = o.target_dy = -10; }), Cause::invalid_argument);
  EXPECT_EQ(cause([](InputOptions& o) { o.target_dx = o.target_dy = 1e-9; }), Cause::invalid_argument);
  EXPECT_EQ(cause([](InputOptions& o) { o.target_dx = o.target_dy = 1e9; }), Cause::invalid_argument);
  RasterOptions nowhere = utm(500000, 5200000);
  nowhere.crs = "";
  InputOptions options;
  options.target_srs = "EPSG:4326";
  EXPECT_THAT(failure_of([&] {
                Source{{plane("n.tif", 4, 4, nowhere)}, options};
              }).what(),
              HasSubstr("InputOptions::srs"));
}

TEST_F(WarpTest, InfinitiesAreNamedNotSmeared) {
  Terrain terrain = support::surface(30, 30, [](int, int) { return 5; });
  terrain.at(12, 14) = std::numeric_limits<double>::infinity();
  InputOptions options;
  options.target_dx = options.target_dy = 7;
  const Source source{{write("i.tif", terrain, utm(500000, 5200000, 10, SampleType::float64))}, options};
  const Failure failure = failure_of([&] { static_cast<void>(all_codes(source)); });
  EXPECT_EQ(failure.cause(), Cause::invalid_argument);
  EXPECT_THAT(failure.what(), AllOf(HasSubstr("i.tif"), HasSubstr("inf")));
}

}  // namespace
}  // namespace talus
