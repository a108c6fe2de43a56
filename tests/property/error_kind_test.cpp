// Databases with errors of other kinds: what they promise is kept, what they do not is said.

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "engine/quadtree/grid.hpp"
#include "engine/stream/stream_codec.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/inputs.hpp"
#include "tests/support/random_raster.hpp"

namespace talus::support {
namespace {

struct Kind {
  ErrorKind kind;
  ErrorMetric metric;
};
constexpr Kind kNested{ErrorKind::nested, ErrorMetric::vertical}, kMidpoint{ErrorKind::midpoint, ErrorMetric::vertical},
    kPerpendicular{ErrorKind::exact, ErrorMetric::perpendicular},
    kBoth{ErrorKind::midpoint, ErrorMetric::perpendicular};

IngestOptions options_of(Kind kind, double void_weight = 1) {
  IngestOptions options;
  options.error_kind = kind.kind;
  options.error_metric = kind.metric;
  options.no_guarantee = kind.kind == ErrorKind::midpoint;
  options.void_weight = void_weight;
  return options;
}

SampleReader truth_of(const Raster& raster) {
  return [&raster](GridRect part) { return raster.read(part); };
}

TEST(ErrorKinds, NestedErrorsKeepThePromise) {
  for (int i = 0; i < property_cases(60); ++i) {
    const std::uint64_t seed = property_seed().value_or(71000 + static_cast<std::uint64_t>(i));
    const RandomRaster raster = random_raster(seed, {1, 1, 200, 150});
    SCOPED_TRACE("TALUS_PROPERTY_SEED=" + std::to_string(seed) + ": " + raster.description);
    const TempFolder folder;
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    ingest(folder / "a.tif", folder / "exact.talus", options_of({}, raster.void_weight));
    ingest(folder / "a.tif", folder / "nested.talus", options_of(kNested, raster.void_weight));
    const Snapshot exact = Database::open(folder / "exact.talus").snapshot();
    const Snapshot nested = Database::open(folder / "nested.talus").snapshot();
    EXPECT_EQ(nested.description().error_kind, ErrorKind::nested);
    Random random(seed);
    const GridRect region = random_region(random, raster.terrain);
    const Metres tolerance{random_tolerance(random)};
    const Answer fewer = exact.ask({.region = region, .tolerance = tolerance}),
                 more = nested.ask({.region = region, .tolerance = tolerance});
    const OracleReport report = check_mesh(triangulate(more.quadtree), raster.terrain,
                                           nested.description().metres_per_unit, tolerance.value, raster.judging);
    EXPECT_TRUE(report.sound()) << report.summary();
    EXPECT_LE(report.largest_error, more.quadtree.bound.value + 1e-9);
    EXPECT_GE(more.quadtree.vertices.size(), fewer.quadtree.vertices.size());
    EXPECT_EQ(verify(nested).findings, std::vector<std::string>());
    if (property_seed() || HasFailure()) break;
  }
}

TEST(ErrorKinds, PerpendicularErrorsKeepThePromiseAtRightAngles) {
  double steepest = 0;
  for (int i = 0; i < property_cases(60); ++i) {
    const std::uint64_t seed = property_seed().value_or(72000 + static_cast<std::uint64_t>(i));
    const RandomRaster raster = random_raster(seed, {1, 1, 200, 150});
    SCOPED_TRACE("TALUS_PROPERTY_SEED=" + std::to_string(seed) + ": " + raster.description);
    const TempFolder folder;
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    ingest(folder / "a.tif", folder / "a.talus", options_of(kPerpendicular, raster.void_weight));
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    Random random(seed);
    const Metres tolerance{random_tolerance(random)};
    const Raster truth(folder / "a.tif");
    const VerifyReport report = verify(now, truth_of(truth), tolerance);
    EXPECT_EQ(report.findings, std::vector<std::string>());
    ASSERT_TRUE(report.perpendicular_error);
    EXPECT_LE(report.perpendicular_error->value, tolerance.value * (1 + 1e-6) + 1e-9);
    EXPECT_LE(*report.perpendicular_error, *report.true_error);
    if (std::isfinite(tolerance.value) && tolerance.value > 0)
      steepest = std::max(steepest, report.true_error->value / tolerance.value);
    if (property_seed() || HasFailure()) break;
  }
  if (property_seed()) return;
  EXPECT_GT(steepest, 1.5) << "no case tells the metrics apart";
}

/// The distance of the surface of an answer from a sample, at right angles, and along the vertical.
TEST(ErrorKinds, ASlopeIsNearerAtRightAnglesThanAlongTheVertical) {
  const TempFolder folder;
  // A slope of 1 in cells of 10 m, across which every second sample of every second row stands 6 m out of the plane.
  const Terrain terrain =
      surface(65, 65, [](int col, int row) { return 10 * col + (col % 2 == 1 && row % 2 == 1 ? 6 : 0); });
  RasterOptions file;
  file.geotransform = {0, 10, 0, 0, 0, -10};
  file.crs = "EPSG:25832";
  write_raster(terrain, folder / "a.tif", file);
  ingest(folder / "a.tif", folder / "vertical.talus");
  ingest(folder / "a.tif", folder / "perpendicular.talus", options_of(kPerpendicular));
  const Raster truth(folder / "a.tif");
  const auto checked = [&](const char* name, double tolerance) {
    return verify(Database::open(folder / name).snapshot(), truth_of(truth), Metres{tolerance});
  };
  const double across = 6 * std::sqrt(0.5);
  EXPECT_EQ(checked("vertical.talus", 5.9).true_error->value, 0);
  const VerifyReport loose = checked("perpendicular.talus", across + 0.01),
                     strict = checked("perpendicular.talus", across - 0.05);
  EXPECT_EQ(loose.true_error->value, 6);
  EXPECT_NEAR(loose.perpendicular_error->value, across, 1e-6);
  EXPECT_LT(loose.vertices, 1000u);
  EXPECT_EQ(strict.true_error->value, 0);
}

/// Vertices whose distance from the middle of their side is above the tolerance, and all they depend on.
VertexMask naive_midpoint_answer(const Terrain& terrain, double tolerance) {
  const GridRect extent{{0, 0}, {terrain.cols - 1, terrain.rows - 1}};
  VertexMask chosen(extent);
  const auto insert = [&](auto&& self, GridPoint p) -> void {
    if (!extent.contains(p) || chosen.contains(p)) return;
    chosen.insert(p);
    if (spacing(p) >= root_side(extent)) return;
    for (const GridPoint parent : diamond(p).apexes) self(self, parent);
  };
  for (std::int32_t row = 0; row < terrain.rows; ++row) {
    for (std::int32_t col = 0; col < terrain.cols; ++col) {
      const GridPoint p{col, row};
      if (spacing(p) >= root_side(extent)) continue;
      const Diamond d = diamond(p);
      if (!extent.contains(d.ends[0]) || !extent.contains(d.ends[1])) continue;
      const double middle = (terrain.at(d.ends[0].col, d.ends[0].row) + terrain.at(d.ends[1].col, d.ends[1].row)) / 2;
      if (std::abs(terrain.at(col, row) - middle) > tolerance) insert(insert, p);
    }
  }
  return chosen;
}

TEST(ErrorKinds, MidpointErrorsSelectWhatTheirDefinitionSelects) {
  // 1,025 samples: vertices of all spacings, those of tiles and those above them.
  for (const auto& [cols, rows] : {std::pair{65, 65}, {257, 129}, {1025, 300}, {2049, 40}}) {
    SCOPED_TRACE(cols);
    Random random(static_cast<std::uint64_t>(cols));
    double height = 0;
    const Terrain terrain =
        surface(cols, rows, [&](int, int) { return height = std::round(0.9 * height + random.between(-60, 60)); });
    const TempFolder folder;
    write_raster(terrain, folder / "a.tif", {});
    ingest(folder / "a.tif", folder / "a.talus", options_of(kMidpoint));
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    for (const double tolerance : {0.0, 3.0, 20.0, 55.0, 100.0}) {
      const Answer answer = now.ask({.region = {{0, 0}, {cols - 1, rows - 1}}, .tolerance = Metres{tolerance}});
      const VertexMask naive = naive_midpoint_answer(terrain, tolerance);
      std::size_t missing = 0, extra = 0;
      for (std::int32_t row = 0; row < rows; ++row) {
        for (std::int32_t col = 0; col < cols; ++col) {
          const bool has = answer.quadtree.vertices.contains({col, row}), needs = naive.contains({col, row});
          missing += needs && !has;
          extra += has && !needs;
        }
      }
      EXPECT_EQ(missing, 0u) << tolerance;
      EXPECT_LE(extra, answer.border_vertices + 64) << tolerance;  // what the border needs, and root corners
      EXPECT_TRUE(std::isinf(answer.quadtree.bound.value)) << "a bound that is none";
      EXPECT_EQ(answer.quadtree.tolerance.value, tolerance);
    }
  }
}

TEST(ErrorKinds, MidpointErrorsBreakThePromiseAndSayHowFar) {
  // Saw-teeth: every vertex of spacing 2 and more lies in the middle of its ends, those between do not.
  const TempFolder folder;
  const Terrain terrain = surface(65, 65, [](int col, int) {
    return col % 8 == 1 || col % 8 == 7 ? 0 : (col / 8 % 2) * 4 + (col % 8 == 4 ? 30 : 0);
  });
  write_raster(terrain, folder / "a.tif", {});
  ingest(folder / "a.tif", folder / "exact.talus");
  ingest(folder / "a.tif", folder / "midpoint.talus", options_of(kMidpoint));
  const Raster truth(folder / "a.tif");
  const VerifyReport kept = verify(Database::open(folder / "exact.talus").snapshot(), truth_of(truth), Metres{16});
  const VerifyReport broken = verify(Database::open(folder / "midpoint.talus").snapshot(), truth_of(truth), Metres{16});
  EXPECT_LE(kept.true_error->value, 16);
  EXPECT_GT(broken.true_error->value, 16) << "a terrain that midpoints do not miss shows nothing";
  EXPECT_EQ(broken.findings, std::vector<std::string>()) << "what was never promised is no damage";
}

TEST(ErrorKinds, UpdatesGoOnWithTheKindOfTheDatabase) {
  Random random(9);
  const Terrain whole = surface(
      1300, 140, [&](int col, int row) { return std::round(90 * std::sin(col / 31.0) + row) + random.between(0, 9); });
  const auto part = [&](int from, int to) {
    return surface(to - from, 140, [&](int col, int row) { return whole.at(from + col, row); });
  };
  const auto at = [](int col) {
    RasterOptions options;
    options.crs = "EPSG:25832";
    options.geotransform = {500000.0 + 10 * col, 10, 0, 5200000, 0, -10};
    return options;
  };
  for (const Kind kind : {kNested, kMidpoint, kPerpendicular, kBoth}) {
    SCOPED_TRACE(std::string(name_of(kind.kind)) + " " + name_of(kind.metric));
    const TempFolder folder;
    write_raster(whole, folder / "whole.tif", at(0));
    write_raster(part(0, 700), folder / "west.tif", at(0));
    write_raster(part(700, 1300), folder / "east.tif", at(700));
    ingest(folder / "whole.tif", folder / "whole.talus", options_of(kind));
    ingest(folder / "west.tif", folder / "grown.talus", options_of(kind));
    update({folder / "east.tif"}, folder / "grown.talus");
    const Snapshot a = Database::open(folder / "whole.talus").snapshot(),
                   b = Database::open(folder / "grown.talus").snapshot();
    EXPECT_EQ(b.description().error_kind, kind.kind);
    EXPECT_EQ(b.description().error_metric, kind.metric);
    EXPECT_EQ(verify(b).findings, std::vector<std::string>());
    for (const double tolerance : {0.0, 2.0, 7.0, 40.0}) {
      const GridRect all = a.description().extent;
      const Answer x = a.ask({.region = all, .tolerance = Metres{tolerance}}),
                   y = b.ask({.region = all, .tolerance = Metres{tolerance}});
      EXPECT_EQ(x.quadtree.vertices.size(), y.quadtree.vertices.size()) << tolerance;
      EXPECT_TRUE(std::ranges::equal(x.quadtree.heights, y.quadtree.heights)) << tolerance;
    }
  }
}

TEST(ErrorKinds, AreRefusedWhereTheyPromiseNothing) {
  const TempFolder folder;
  write_raster(spike(40, 40, 7, 9), folder / "a.tif", {});
  const auto refused = [&](IngestOptions options) {
    return failure_of([&] { ingest(folder / "a.tif", folder / "a.talus", options); });
  };
  IngestOptions midpoint = options_of(kMidpoint);
  midpoint.no_guarantee = false;
  EXPECT_EQ(refused(midpoint).cause(), Cause::invalid_argument);
  EXPECT_NE(std::string(refused(midpoint).what()).find("IngestOptions::no_guarantee"), std::string::npos);
  EXPECT_EQ(refused(options_of({ErrorKind::nested, ErrorMetric::perpendicular})).cause(), Cause::invalid_argument);
  IngestOptions kept = options_of(kPerpendicular);
  kept.finest_tolerance = Metres{2};
  EXPECT_EQ(refused(kept).cause(), Cause::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.talus"));
  for (const Kind kind : {kMidpoint, kPerpendicular}) {
    IngestOptions options = options_of(kind);
    options.overwrite = true;
    ingest(folder / "a.tif", folder / "a.talus", options);
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    const GridRect all = now.description().extent;
    for (const Failure& failure :
         {failure_of([&] {
            static_cast<void>(
                now.ask({.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::bounded}}));
          }),
          failure_of([&] {
            static_cast<void>(now.ask({.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::dense}}));
          }),
          failure_of([&] {
            static_cast<void>(now.ask({.region = all,
                                       .tolerance = Metres{5},
                                       .heights = {.kind = HeightKind::bounded, .quantum = Metres{1}}}));
          })}) {
      EXPECT_EQ(failure.cause(), Cause::invalid_argument);
      EXPECT_NE(std::string(failure.what()).find("exact heights"), std::string::npos) << failure.what();
    }
  }
}

TEST(ErrorKinds, StreamsSayWhichErrorsTheyWereChosenBy) {
  for (const Kind kind : {Kind{}, kNested, kMidpoint, kPerpendicular, kBoth}) {
    SCOPED_TRACE(std::string(name_of(kind.kind)) + " " + name_of(kind.metric));
    const TempFolder folder;
    Random random(3);
    write_raster(surface(90, 70, [&](int, int) { return random.between(0, 99); }), folder / "a.tif", {});
    ingest(folder / "a.tif", folder / "a.talus", options_of(kind));
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    const GridRect all = now.description().extent;
    const Stream coarse =
        decode_stream(encode({now.description(), now.ask({.region = all, .tolerance = Metres{40}}).quadtree}, {}));
    EXPECT_EQ(coarse.description.error_kind, kind.kind);
    EXPECT_EQ(coarse.description.error_metric, kind.metric);
    const auto& base = std::get<RestrictedQuadtree>(coarse.content);
    EXPECT_EQ(std::isinf(base.bound.value), kind.kind == ErrorKind::midpoint);
    // Refinement does not ask what errors mean.
    const RestrictedQuadtree finer =
        merge(base, increment_of(now.ask({.region = all, .tolerance = Metres{10}, .from = Metres{40}})));
    const RestrictedQuadtree asked = now.ask({.region = all, .tolerance = Metres{10}}).quadtree;
    EXPECT_TRUE(std::ranges::equal(finer.heights, asked.heights));
    EXPECT_EQ(finer.bound, asked.bound);
  }
}

}  // namespace
}  // namespace talus::support
