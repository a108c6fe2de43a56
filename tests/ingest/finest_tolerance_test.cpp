// Databases that keep the vertices of a tolerance only: every answer must be as good as it says, on every rectangle,
// though its border may stand on heights that were not kept.

#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "storage/page_store.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/inputs.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/random.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {
namespace {

/// Rough and flat ground, and holes.
Terrain ground(int cols, int rows, std::uint64_t seed, SampleType type, bool voids) {
  Terrain terrain = fractal(cols, rows, seed, 300);
  Random random(seed);
  for (std::size_t i = 0; i < terrain.values.size(); ++i) {
    double& h = terrain.values[i];
    if (h < 0) h = 0;
    if (type == SampleType::float32) h = std::round(h * 10) / 10;
  }
  for (int k = 0; voids && k < 12; ++k) {
    const int reach = random.between(1, 20), col = random.between(0, cols - 1), row = random.between(0, rows - 1);
    for (int y = std::max(0, row - reach); y < std::min(rows, row + reach); ++y) {
      for (int x = std::max(0, col - reach); x < std::min(cols, col + reach); ++x)
        terrain.valid[static_cast<std::size_t>(y) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(x)] = 0;
    }
  }
  return fit(terrain, type);
}

class Kept {
 public:
  Kept(Terrain terrain, SampleType type, IngestOptions options) : terrain_(std::move(terrain)) {
    RasterOptions file;
    file.type = type;
    write_raster(terrain_, folder_ / "a.tif", file);
    static_cast<void>(ingest(folder_ / "a.tif", path(), options));
  }
  [[nodiscard]] std::filesystem::path path() const { return folder_ / "a.talus"; }
  [[nodiscard]] Snapshot now() const { return Database::open(path()).snapshot(); }
  [[nodiscard]] const Terrain& terrain() const { return terrain_; }
  /// How many tiles have nothing but a slice, and how many have pages.
  [[nodiscard]] std::pair<int, int> tiles() const {
    const ReadTxn txn(PageStore::open(path()));
    int in_slices = 0, all = 0;
    txn.for_each(kSliceTable, [&](std::uint64_t) { ++in_slices; });
    txn.for_each(1, [&](std::uint64_t) { ++all; });
    return {in_slices, all - in_slices};
  }
  [[nodiscard]] std::vector<std::string> findings() const {
    return verify(now(), [&](GridRect r) { return Raster(folder_ / "a.tif").read(r); }).findings;
  }
  void expect_promise(GridRect region, double tolerance, double finest, Heights heights = {}) const {
    const Answer answer = now().ask({.region = region, .tolerance = Metres{tolerance}, .heights = heights});
    EXPECT_LE(answer.quadtree.bound.value, std::max(tolerance, finest) + 1e-8);
    OracleOptions judging{1, 1};
    judging.heights_are_source = false;
    const OracleReport report =
        check_mesh(triangulate(answer.quadtree), terrain_, 1, answer.quadtree.bound.value, judging);
    EXPECT_TRUE(report.sound()) << region.first.col << ',' << region.first.row << ' ' << region.last.col << ','
                                << region.last.row << " at " << tolerance << " of " << finest << ": "
                                << report.summary();
  }

 private:
  TempFolder folder_;
  Terrain terrain_;
};

IngestOptions keeping(double tolerance) {
  IngestOptions options;
  options.finest_tolerance = Metres{tolerance};
  return options;
}

GridRect random_region(Random& random, int cols, int rows) {
  const int c0 = random.between(0, cols - 1), r0 = random.between(0, rows - 1);
  return {{c0, r0}, {random.between(c0, cols - 1), random.between(r0, rows - 1)}};
}

TEST(FinestTolerance, EveryRectangleIsAsGoodAsItSays) {
  std::uint64_t seed = 1;
  for (const SampleType type : {SampleType::int16, SampleType::float32}) {
    for (const bool voids : {false, true}) {
      for (const double finest : {0.3, 2.0, 15.0, 120.0}) {
        const int cols = 300 + static_cast<int>(seed) * 7, rows = 260;
        const Kept kept(ground(cols, rows, ++seed, type, voids), type, keeping(finest));
        EXPECT_EQ(kept.findings(), std::vector<std::string>{});
        kept.expect_promise({{0, 0}, {cols - 1, rows - 1}}, finest, finest);
        Random random(seed);
        for (int i = 0; i < 12; ++i) {
          kept.expect_promise(random_region(random, cols, rows), finest * random.log_between(0.2, 8), finest);
        }
      }
    }
  }
}

std::vector<GridPoint> points_of(const RestrictedQuadtree& quadtree) {
  std::vector<GridPoint> points;
  quadtree.vertices.for_each([&](GridPoint p) { points.push_back(p); });
  return points;
}

/// Where all samples are kept nothing is dropped, so those answers are the reference: the same vertices with the same
/// heights, from slices and from pages, for whole rasters and parts. Borders of parts may need heights that were dropped.
TEST(FinestTolerance, AnswersAreThoseOfAllSamples) {
  int in_slices = 0, in_pages = 0, dropped = 0;
  std::uint64_t seed = 30;
  for (const SampleType type : {SampleType::int16, SampleType::float32}) {
    for (const bool voids : {false, true}) {
      for (const double finest : {0.5, 4.0, 50.0}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", keeping " << finest);
        // With voids, whole pages at the border are not stored.
        const Terrain given = ground(830, 610, ++seed, type, voids);
        const Terrain terrain = voids ? hole(hole(given, 251, 0, 520, 262), 240, 478, 531, 609) : given;
        const Kept kept(terrain, type, keeping(finest)), all(terrain, type, {});
        in_slices += kept.tiles().first, in_pages += kept.tiles().second;
        Random random(seed);
        for (int i = 0; i < 10; ++i) {
          const GridRect region = i < 3 ? GridRect{{0, 0}, {829, 609}} : random_region(random, 830, 610);
          const double tolerance = finest * (i < 3 ? std::pow(2, i) : random.between(1, 20));
          const Question question{.region = region, .tolerance = Metres{tolerance}};
          const RestrictedQuadtree a = kept.now().ask(question).quadtree, b = all.now().ask(question).quadtree;
          const std::vector<GridPoint> points = points_of(a);
          ASSERT_EQ(points, points_of(b));
          ASSERT_EQ(a.covers, b.covers);
          for (std::size_t k = 0; k < a.heights.size(); ++k) {
            if (a.heights[k] == b.heights[k] || !terrain.is_valid(points[k].col, points[k].row)) continue;
            ++dropped;
            ASSERT_GE(i, 3);
            ASSERT_NEAR(a.heights[k], b.heights[k], finest);
          }
        }
      }
    }
  }
  EXPECT_GT(in_slices, 5);
  EXPECT_GE(in_pages, 2);
  EXPECT_GT(dropped, 10);
}

TEST(FinestTolerance, ThinAndTinyRastersKeepWhatTheirBordersNeed) {
  const std::pair<int, int> sizes[] = {{1, 1}, {1, 40}, {2, 2}, {3, 200}, {200, 2}, {5, 130}, {65, 65}, {64, 9}};
  for (const auto& [cols, rows] : sizes) {
    const Kept kept(ground(cols, rows, 77, SampleType::int16, false), SampleType::int16, keeping(40));
    EXPECT_EQ(kept.findings(), std::vector<std::string>{});
    kept.expect_promise({{0, 0}, {cols - 1, rows - 1}}, 0, 40);
    Random random(5);
    for (int i = 0; i < 6; ++i) kept.expect_promise(random_region(random, cols, rows), 40, 40);
  }
}

TEST(FinestTolerance, AnswersOverSeveralTilesKeepIt) {
  const Kept kept(ground(2300, 1300, 4, SampleType::int16, true), SampleType::int16, keeping(25));
  EXPECT_EQ(kept.findings(), std::vector<std::string>{});
  for (const GridRect region : {GridRect{{0, 0}, {2299, 1299}}, {{901, 3}, {1333, 1111}}})
    for (const double tolerance : {0.0, 25.0, 90.0}) kept.expect_promise(region, tolerance, 25);
}

/// Pages of voids alone are not stored, though others of their tiles are, and borders lead into them.
TEST(FinestTolerance, BordersMayEndAmidPagesOfVoids) {
  const Kept kept(hole(ground(700, 500, 4, SampleType::int16, false), 200, 100, 610, 480), SampleType::int16,
                  keeping(5));
  Random random(6);
  for (int i = 0; i < 60; ++i) kept.expect_promise(random_region(random, 700, 500), 20, 5);
}

TEST(FinestTolerance, RoundedHeightsAreInTheBoundToo) {
  IngestOptions options = keeping(6);
  options.inputs.height_step = Metres{4};
  const Kept kept(ground(310, 290, 9, SampleType::float32, false), SampleType::float32, options);
  Random random(3);
  for (int i = 0; i < 8; ++i) kept.expect_promise(random_region(random, 310, 290), random.log_between(1, 30), 6);
}

/// Heights that were dropped lie between others, so they are no whole steps, and a multiple of the step rounds them.
TEST(FinestTolerance, HeightsBetweenStepsAreRoundedWithinTheBound) {
  const Kept kept(ground(420, 390, 12, SampleType::int16, false), SampleType::int16, keeping(2.5));
  Random random(4);
  for (int i = 0; i < 12; ++i) {
    const GridRect region = random_region(random, 420, 390);
    const double tolerance = i % 3 == 0 ? 5 : random.log_between(4, 30);
    for (const Heights heights :
         {Heights{HeightKind::bounded, Metres{1}}, {HeightKind::bounded, Metres{3}}, {HeightKind::dense, Metres{0}}})
      kept.expect_promise(region, tolerance, 2.5, heights);
  }
}

/// Rounding comes on top of what the database leaves out, and only samples could tell how much there is in truth.
TEST(FinestTolerance, RoundedHeightsBeyondTheToleranceAreRefused) {
  const Kept kept(ground(70, 40, 5, SampleType::int16, false), SampleType::int16, keeping(5));
  const auto refusal = [&](double tolerance, Heights heights) {
    return failure_of([&] { static_cast<void>(kept.now().ask({.tolerance = Metres{tolerance}, .heights = heights})); });
  };
  for (const double quantum : {10.0, 5.0, 2.0}) {
    const Heights rounded{HeightKind::bounded, Metres{quantum}};
    const Failure failure = refusal(5 + quantum / 2 - 0.01, rounded);
    EXPECT_EQ(failure.cause(), Cause::invalid_argument);
    EXPECT_NE(std::string(failure.what()).find("kept only the vertices for 5 m"), std::string::npos) << failure.what();
    kept.expect_promise({{0, 0}, {69, 39}}, 5 + quantum / 2, 5, rounded);
  }
  for (const HeightKind kind : {HeightKind::bounded, HeightKind::fitted}) {
    const Failure failure = refusal(20, {kind, Metres{0}});
    EXPECT_EQ(failure.cause(), Cause::unsupported);
    EXPECT_NE(std::string(failure.what()).find("compared with every sample"), std::string::npos) << failure.what();
  }
}

/// What borders stand on is a matter of the database, not of the rectangle.
TEST(FinestTolerance, RectanglesThatShareASideMeet) {
  const Kept kept(ground(300, 300, 12, SampleType::int16, false), SampleType::int16, keeping(30));
  for (const std::int32_t side : {40, 101, 160, 233}) {
    std::map<std::pair<std::int32_t, std::int32_t>, double> west, east;
    const auto points_on_side = [&](GridRect region, auto& to) {
      const Mesh mesh = triangulate(kept.now().ask({.region = region, .tolerance = Metres{30}}).quadtree);
      for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        if (mesh.points[i].col == side) to[{mesh.points[i].col, mesh.points[i].row}] = mesh.heights[i];
      }
    };
    points_on_side({{3, 20}, {side, 277}}, west);
    points_on_side({{side, 20}, {297, 277}}, east);
    EXPECT_GT(west.size(), 2u);
    EXPECT_TRUE(west == east) << "at column " << side;
  }
}

TEST(FinestTolerance, WhatNeedsAllSamplesIsRefused) {
  const Kept kept(ground(200, 200, 3, SampleType::int16, false), SampleType::int16, keeping(5));
  EXPECT_EQ(failure_of([&] { static_cast<void>(kept.now().samples({{0, 0}, {9, 9}})); }).cause(), Cause::unsupported);
  const TempFolder folder;
  write_raster(ground(50, 50, 2, SampleType::int16, false), folder / "new.tif");
  const Failure failure = failure_of([&] { static_cast<void>(update({folder / "new.tif"}, kept.path())); });
  EXPECT_EQ(failure.cause(), Cause::unsupported);
  EXPECT_NE(std::string(failure.what()).find("5 m"), std::string::npos) << failure.what();

  for (const double wrong : {-1.0, 2e6, std::nan("")}) {
    EXPECT_EQ(failure_of([&] {
                static_cast<void>(ingest(folder / "new.tif", folder / "new.talus", keeping(wrong)));
              }).cause(),
              Cause::invalid_argument);
  }
  IngestOptions rounded = keeping(2);
  rounded.inputs.height_step = Metres{4};
  EXPECT_EQ(failure_of([&] { static_cast<void>(ingest(folder / "new.tif", folder / "new.talus", rounded)); }).cause(),
            Cause::invalid_argument);
}

TEST(FinestTolerance, AFileIsNeverMuchLargerForIt) {
  const Terrain terrain = ground(600, 600, 21, SampleType::int16, false);
  const auto bytes = [&](double finest) {
    return std::filesystem::file_size(Kept(terrain, SampleType::int16, keeping(finest)).path());
  };
  const auto all = bytes(0);
  EXPECT_LE(bytes(0.5), all + all / 12) << "errors are codes, which take more bytes than eighths";
  EXPECT_LT(bytes(30), all / 3);
}

}  // namespace
}  // namespace talus::support
