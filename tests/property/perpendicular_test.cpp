// Databases with perpendicular errors: they keep their promise at right angles, and refuse what needs vertical errors.

#include <cmath>
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

IngestOptions perpendicular(double void_weight = 1) {
  IngestOptions options;
  options.error_metric = ErrorMetric::perpendicular;
  options.void_weight = void_weight;
  return options;
}

SampleReader truth_of(const Raster& raster) {
  return [&raster](GridRect part) { return raster.read(part); };
}

TEST(PerpendicularErrors, KeepThePromiseAtRightAngles) {
  double steepest = 0;
  for (int i = 0; i < property_cases(60); ++i) {
    const std::uint64_t seed = property_seed().value_or(72000 + static_cast<std::uint64_t>(i));
    const RandomRaster raster = random_raster(seed, {1, 1, 200, 150});
    SCOPED_TRACE("TALUS_PROPERTY_SEED=" + std::to_string(seed) + ": " + raster.description);
    const TempFolder folder;
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    ingest(folder / "a.tif", folder / "a.talus", perpendicular(raster.void_weight));
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
TEST(PerpendicularErrors, AreSmallerOnASlopeThanVerticalOnes) {
  const TempFolder folder;
  // A slope of 1 in cells of 10 m, across which every second sample of every second row stands 6 m out of the plane.
  const Terrain terrain =
      surface(65, 65, [](int col, int row) { return 10 * col + (col % 2 == 1 && row % 2 == 1 ? 6 : 0); });
  RasterOptions file;
  file.geotransform = {0, 10, 0, 0, 0, -10};
  file.crs = "EPSG:25832";
  write_raster(terrain, folder / "a.tif", file);
  ingest(folder / "a.tif", folder / "vertical.talus");
  ingest(folder / "a.tif", folder / "perpendicular.talus", perpendicular());
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

TEST(PerpendicularErrors, StayThoseOfTheDatabaseInUpdates) {
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
  const TempFolder folder;
  write_raster(whole, folder / "whole.tif", at(0));
  write_raster(part(0, 700), folder / "west.tif", at(0));
  write_raster(part(700, 1300), folder / "east.tif", at(700));
  ingest(folder / "whole.tif", folder / "whole.talus", perpendicular());
  ingest(folder / "west.tif", folder / "grown.talus", perpendicular());
  update({folder / "east.tif"}, folder / "grown.talus");
  const Snapshot a = Database::open(folder / "whole.talus").snapshot(),
                 b = Database::open(folder / "grown.talus").snapshot();
  EXPECT_EQ(b.description().error_metric, ErrorMetric::perpendicular);
  EXPECT_EQ(verify(b).findings, std::vector<std::string>());
  for (const double tolerance : {0.0, 2.0, 7.0, 40.0}) {
    const GridRect all = a.description().extent;
    const Answer x = a.ask({.region = all, .tolerance = Metres{tolerance}}),
                 y = b.ask({.region = all, .tolerance = Metres{tolerance}});
    EXPECT_EQ(x.quadtree.vertices.size(), y.quadtree.vertices.size()) << tolerance;
    EXPECT_TRUE(std::ranges::equal(x.quadtree.heights, y.quadtree.heights)) << tolerance;
  }
}

TEST(PerpendicularErrors, AreRefusedWhereHeightsNeedVerticalOnes) {
  const TempFolder folder;
  write_raster(spike(40, 40, 7, 9), folder / "a.tif", {});
  const auto refused = [&](IngestOptions options) {
    return failure_of([&] { ingest(folder / "a.tif", folder / "a.talus", options); });
  };
  IngestOptions kept = perpendicular();
  kept.finest_tolerance = Metres{2};
  EXPECT_EQ(refused(kept).cause(), Cause::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.talus"));
  ingest(folder / "a.tif", folder / "a.talus", perpendicular());
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  const GridRect all = now.description().extent;
  for (const Failure& failure :
       {failure_of([&] {
          static_cast<void>(now.ask({.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::bounded}}));
        }),
        failure_of([&] {
          static_cast<void>(now.ask({.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::dense}}));
        }),
        failure_of([&] {
          static_cast<void>(now.ask(
              {.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::bounded, .quantum = Metres{1}}}));
        })}) {
    EXPECT_EQ(failure.cause(), Cause::invalid_argument);
    EXPECT_NE(std::string(failure.what()).find("exact heights"), std::string::npos) << failure.what();
  }
}

TEST(PerpendicularErrors, AreNamedByStreams) {
  for (const IngestOptions& options : {IngestOptions{}, perpendicular()}) {
    SCOPED_TRACE(name_of(options.error_metric));
    const TempFolder folder;
    Random random(3);
    write_raster(surface(90, 70, [&](int, int) { return random.between(0, 99); }), folder / "a.tif", {});
    ingest(folder / "a.tif", folder / "a.talus", options);
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    const GridRect all = now.description().extent;
    const Stream coarse =
        decode_stream(encode({now.description(), now.ask({.region = all, .tolerance = Metres{40}}).quadtree}, {}));
    EXPECT_EQ(coarse.description.error_metric, options.error_metric);
    const auto& base = std::get<RestrictedQuadtree>(coarse.content);
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
