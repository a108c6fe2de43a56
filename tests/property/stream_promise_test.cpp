// What a reader of a stream gets: the answer bit for bit, its surface within the tolerance, and each of its prefixes
// within the bound that it states. For random rasters, regions, tolerances and heights, and for real terrain.
//
// TALUS_PROPERTY_CASES=20000 tries 2,000 rasters with nine streams each.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>

#include <gtest/gtest.h>

#include "engine/stream/stream_codec.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/quadtrees.hpp"
#include "tests/support/random_raster.hpp"
#include "tests/support/real_models.hpp"

namespace talus::support {
namespace {

using Bytes = std::vector<std::byte>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class Heights { exact, bounded, quantised, dense, fitted, finely_fitted };

struct Case {
  const Snapshot& now;
  const Terrain& terrain;
  OracleOptions judging;
  double tolerance = 0;
};

/// A decoded answer's mesh against every sample.
void expect_within(const Case& c, const RestrictedQuadtree& q, double bound, bool is_source, const char* what) {
  OracleOptions options = c.judging;
  options.heights_are_source = is_source;
  // Outlines are as fine as the tolerance asks, however much better the surface came out.
  options.void_weight *= bound / std::max(bound, c.tolerance);
  if (!(bound < kInfinity)) options.void_weight = 0;
  const OracleReport report =
      check_mesh(triangulate(q), c.terrain, c.now.description().metres_per_unit, bound, options);
  EXPECT_TRUE(report.sound()) << what << " at " << bound << " m: " << report.summary();
}

Answer asked(const Snapshot& now, GridRect region, Metres tolerance, Heights heights, Metres quantum) {
  return heights == Heights::exact       ? now.ask({.region = region, .tolerance = tolerance})
         : heights == Heights::quantised ? now.ask({.region = region,
                                                    .tolerance = tolerance,
                                                    .heights = {.kind = HeightKind::bounded, .quantum = quantum}})
         : heights == Heights::dense
             ? now.ask({.region = region, .tolerance = tolerance, .heights = {.kind = HeightKind::dense}})
         : heights == Heights::fitted
             ? now.ask({.region = region, .tolerance = tolerance, .heights = {.kind = HeightKind::fitted}})
         : heights == Heights::finely_fitted
             ? now.ask({.region = region,
                        .tolerance = tolerance,
                        .heights = {.kind = HeightKind::fitted, .quantum = Metres{tolerance.value / 20}}})
             : now.ask({.region = region, .tolerance = tolerance, .heights = {.kind = HeightKind::bounded}});
}

/// One stream and all its prefixes.
void expect_stream(const Case& c, const RestrictedQuadtree& answer, const StreamOptions& options, bool judge_prefixes) {
  const Bytes bytes = encode({c.now.description(), answer}, options);
  const bool is_source = answer.origin.quantum.value == 0;
  const auto back = std::get<RestrictedQuadtree>(decode_stream(bytes).content);
  ASSERT_EQ(difference(back, answer), "");
  expect_within(c, back, answer.tolerance.value, is_source, "decoded");
  if (!judge_prefixes) return;
  StreamDecoder decoder;
  std::size_t parts = 0;
  double last = kInfinity;
  // A byte at a time would do; a part comes with its last byte, so pieces of any size show every part but few in
  // between.
  for (std::size_t at = 0; at < bytes.size(); at += 7) {
    decoder.add(std::span(bytes).subspan(at, std::min<std::size_t>(7, bytes.size() - at)));
    if (decoder.parts() == parts) continue;
    parts = decoder.parts();
    const auto prefix = std::get<RestrictedQuadtree>(decoder.stream().content);
    EXPECT_EQ(prefix.bound, decoder.bound());
    EXPECT_LE(prefix.bound.value, last) << "bounds never rise";
    last = prefix.bound.value;
    expect_within(c, prefix, prefix.bound.value, is_source, "a prefix");
  }
  EXPECT_EQ(parts, decoder.parts_in_all());
}

class StreamPromise : public ::testing::TestWithParam<int> {};

TEST_P(StreamPromise, HoldsOnTheOtherSideOfTheWire) {
  constexpr int kShards = 4;
  const int cases = property_cases(160);
  for (int i = GetParam(); i < cases; i += kShards) {
    const std::uint64_t seed = property_seed().value_or(91000 + static_cast<std::uint64_t>(i));
    const RandomRaster raster = random_raster(seed);
    SCOPED_TRACE("TALUS_PROPERTY_SEED=" + std::to_string(seed) + " " + raster.description);
    const TempFolder folder;
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    IngestOptions ingesting;
    ingesting.void_weight = raster.void_weight;
    ingest(folder / "a.tif", folder / "a.talus", ingesting);
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    Random random(seed);
    const GridRect region = random_region(random, raster.terrain);
    const Metres tolerance{random.log_between(0.05, 100)};
    const Case c{now, raster.terrain, raster.judging, tolerance.value};
    const Metres quantum{tolerance.value * random.log_between(0.1, 1)};
    for (const Heights heights : {Heights::exact, Heights::bounded, Heights::quantised, Heights::dense, Heights::fitted,
                                  Heights::finely_fitted}) {
      SCOPED_TRACE("heights " + std::to_string(static_cast<int>(heights)));
      const RestrictedQuadtree answer = asked(now, region, tolerance, heights, quantum).quadtree;
      EXPECT_LE(answer.bound.value, tolerance.value + 1e-8);
      expect_stream(c, answer, {.stripes = random.between(0, 3)}, true);
      if (HasFailure()) return;
    }
    if (property_seed()) break;
  }
}

INSTANTIATE_TEST_SUITE_P(Shards, StreamPromise, ::testing::Range(0, 4));

TEST(BoundedHeights, OfNeighboursMeet) {
  const int cases = property_cases(60);
  int compared = 0;
  for (int i = 0; i < cases; ++i) {
    const std::uint64_t seed = 92000 + static_cast<std::uint64_t>(i);
    const RandomRaster raster = random_raster(seed);
    const std::int32_t cols = raster.terrain.cols, rows = raster.terrain.rows;
    if (cols < 40 || rows < 2 || raster.terrain.has_voids()) continue;
    SCOPED_TRACE(raster.description);
    const TempFolder folder;
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    ingest(folder / "a.tif", folder / "a.talus");
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    Random random(seed);
    const std::int32_t middle = random.between(16, cols - 18);
    const Metres tolerance{random.log_between(0.1, 100)};
    const GridRect west{{0, 0}, {middle, rows - 1}}, east{{middle, 0}, {cols - 1, rows - 1}},
        both{{0, 0}, {cols - 1, rows - 1}};
    OracleOptions options = raster.judging;
    options.heights_are_source = false;
    for (const Heights heights : {Heights::bounded, Heights::quantised, Heights::fitted, Heights::finely_fitted}) {
      const auto a = asked(now, west, tolerance, heights, tolerance).quadtree,
                 b = asked(now, east, tolerance, heights, tolerance).quadtree;
      const OracleReport report = check_mesh(join(triangulate(a), triangulate(b), both), raster.terrain,
                                             now.description().metres_per_unit, tolerance.value, options);
      ASSERT_TRUE(report.sound()) << report.summary();
    }
    ++compared;
  }
  EXPECT_GT(compared, cases / 10);
}

TEST(FittedHeights, KeepTheBoundWhateverTheQuantum) {
  const TempFolder folder;
  const Terrain terrain = fit(random_voids(fractal(70, 50, 3, 300), 0.02, 7), SampleType::int16);
  write_raster(terrain, folder / "a.tif", {});
  ingest(folder / "a.tif", folder / "a.talus");
  IngestOptions rounded;
  rounded.inputs.height_step = Metres{4};
  ingest(folder / "a.tif", folder / "rounded.talus", rounded);
  for (const char* name : {"a.talus", "rounded.talus"}) {
    const Snapshot now = Database::open(folder / name).snapshot();
    const GridRect all = now.description().extent;
    for (const double tolerance : {0.3, 1.0, 2.1, 7.0, 50.0}) {
      for (const double quantum : {0.0, 0.01, 1.0, 3.0, 5.0}) {
        SCOPED_TRACE(::testing::Message() << name << ", " << tolerance << " m by " << quantum);
        std::optional<Answer> answer;
        try {
          answer = now.ask({.region = all,
                            .tolerance = Metres{tolerance},
                            .heights = {.kind = HeightKind::fitted, .quantum = Metres{quantum}}});
        } catch (const Failure& refused) {
          EXPECT_EQ(refused.cause(), Cause::invalid_argument);
          EXPECT_TRUE(quantum > tolerance || tolerance <= 2 + quantum) << refused.what();
          continue;
        }
        OracleOptions options;
        options.heights_are_source = false;
        const OracleReport report = check_mesh(triangulate(answer->quadtree), terrain, 1, tolerance, options);
        EXPECT_TRUE(report.sound()) << report.summary();
        EXPECT_LE(answer->quadtree.bound.value, tolerance + 1e-8);
      }
    }
  }
}

/// Small rasters are mostly border; real terrain: docs/accuracy.md.
TEST(FittedHeights, NeedFewerVertices) {
  const TempFolder folder;
  const Terrain terrain = fit(fractal(257, 257, 31, 900), SampleType::int16);
  write_raster(terrain, folder / "a.tif", {});
  ingest(folder / "a.tif", folder / "a.talus");
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  const GridRect all{{0, 0}, {256, 256}};
  for (const double tolerance : {5.0, 20.0, 60.0}) {
    const auto vertices = [&](Heights heights) {
      return asked(now, all, Metres{tolerance}, heights, Metres{1}).quadtree.vertices.size();
    };
    const std::size_t exact = vertices(Heights::exact), fitted = vertices(Heights::fitted),
                      finely = vertices(Heights::finely_fitted);
    EXPECT_LT(fitted, exact) << tolerance;
    EXPECT_LT(finely, exact * 9 / 10) << tolerance;
  }
}

TEST(BoundedHeights, OfOneQuantumMergeToTheAnswerAskedInOneGo) {
  const int cases = property_cases(60);
  for (int i = 0; i < cases; ++i) {
    const std::uint64_t seed = 93000 + static_cast<std::uint64_t>(i);
    const RandomRaster raster = random_raster(seed);
    SCOPED_TRACE(raster.description);
    const TempFolder folder;
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    ingest(folder / "a.tif", folder / "a.talus");
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    Random random(seed);
    const GridRect region = random_region(random, raster.terrain);
    const Metres quantum{random.log_between(0.05, 5)};
    const Metres chain[] = {Metres{kInfinity}, Metres{quantum.value * 8}, Metres{quantum.value * 3},
                            Metres{quantum.value / 2}};
    RestrictedQuadtree client =
        now.ask({.region = region, .tolerance = chain[0], .heights = {.kind = HeightKind::bounded, .quantum = quantum}})
            .quadtree;
    for (std::size_t step = 1; step < 4; ++step) {
      const Increment more = increment_of(now.ask({.region = region,
                                                   .tolerance = chain[step],
                                                   .from = chain[step - 1],
                                                   .heights = {.kind = HeightKind::bounded, .quantum = quantum}}));
      const Bytes bytes = encode({now.description(), more}, {}, &client);
      client = merge(client, std::get<Increment>(decode_stream(bytes, {}, &client).content));
      ASSERT_EQ(difference(client, now.ask({.region = region,
                                            .tolerance = chain[step],
                                            .heights = {.kind = HeightKind::bounded, .quantum = quantum}})
                                       .quadtree),
                "");
    }
    // What does not belong together stays apart.
    const Increment exact = increment_of(now.ask({.region = region, .tolerance = chain[3], .from = chain[1]}));
    EXPECT_THROW(static_cast<void>(merge(now.ask({.region = region,
                                                  .tolerance = chain[1],
                                                  .heights = {.kind = HeightKind::bounded, .quantum = quantum}})
                                             .quadtree,
                                         exact)),
                 Failure);
    EXPECT_THROW(static_cast<void>(encode({now.description(), exact}, {}, &client)), Failure);
    EXPECT_THROW(
        static_cast<void>(
            merge(now.ask({.region = region, .tolerance = chain[1], .heights = {.kind = HeightKind::bounded}}).quadtree,
                  exact)),
        Failure);
  }
}

TEST(BoundedHeights, RefuseWhatTheyCannotKeep) {
  const TempFolder folder;
  write_raster(fit(fractal(40, 33, 4, 200), SampleType::int16), folder / "a.tif");
  ingest(folder / "a.tif", folder / "a.talus");
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  const GridRect all = now.description().extent;
  EXPECT_THROW(
      static_cast<void>(now.ask({.region = all, .tolerance = Metres{0}, .heights = {.kind = HeightKind::bounded}})),
      Failure);
  EXPECT_THROW(static_cast<void>(
                   now.ask({.region = all, .tolerance = Metres{kInfinity}, .heights = {.kind = HeightKind::bounded}})),
               Failure);
  EXPECT_THROW(
      static_cast<void>(now.ask({.region = all, .tolerance = Metres{0}, .heights = {.kind = HeightKind::dense}})),
      Failure);
  EXPECT_THROW(static_cast<void>(
                   now.ask({.region = all, .tolerance = Metres{kInfinity}, .heights = {.kind = HeightKind::dense}})),
               Failure);
  EXPECT_THROW(
      static_cast<void>(now.ask(
          {.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::bounded, .quantum = Metres{12}}})),
      Failure);
  EXPECT_NO_THROW(static_cast<void>(now.ask(
      {.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::bounded, .quantum = Metres{11}}})))
      << "whole numbers lie at most 5 from a multiple of 11";
  EXPECT_THROW(
      static_cast<void>(now.ask(
          {.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::bounded, .quantum = Metres{-1}}})),
      Failure);
  EXPECT_THROW(
      static_cast<void>(now.ask(
          {.region = all, .tolerance = Metres{1}, .heights = {.kind = HeightKind::bounded, .quantum = Metres{5}}})),
      Failure);
  EXPECT_THROW(
      static_cast<void>(increment_of(now.ask({.region = all,
                                              .tolerance = Metres{1},
                                              .from = Metres{5},
                                              .heights = {.kind = HeightKind::bounded, .quantum = Metres{5}}}))),
      Failure);
  IngestOptions lossy;
  lossy.finest_tolerance = Metres{2};
  ingest(folder / "a.tif", folder / "b.talus", lossy);
  const Snapshot kept = Database::open(folder / "b.talus").snapshot();
  EXPECT_THROW(
      static_cast<void>(kept.ask({.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::bounded}})),
      Failure);
  EXPECT_EQ(
      kept.ask({.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::dense}}).quadtree.origin.quantum,
      Metres{6})
      << "2 m of the 5 are lost already, and dropped heights are no whole metres";
  EXPECT_EQ(
      now.ask({.region = all, .tolerance = Metres{5}, .heights = {.kind = HeightKind::dense}}).quadtree.origin.quantum,
      Metres{11});
  EXPECT_EQ(now.ask({.region = all, .tolerance = Metres{0.5}, .heights = {.kind = HeightKind::dense}}).quadtree.heights,
            now.ask({.region = all, .tolerance = Metres{0.5}}).quadtree.heights);
}

class StreamsOfRealModels : public ::testing::TestWithParam<const char*> {};

TEST_P(StreamsOfRealModels, KeepThePromise) {
  const TempFolder folder;
  const RealModel model = real_model(GetParam(), folder);
  if (!model.file) GTEST_SKIP() << model.why_not;
  const Terrain terrain = read_raster(*model.file);
  ingest(*model.file, folder / "model.talus");
  const Snapshot now = Database::open(folder / "model.talus").snapshot();
  const GridRect extent = now.description().extent;
  for (const double tolerance : {1.0, 5.0, 20.0}) {
    const Case c{now, terrain, {}, tolerance};
    const RestrictedQuadtree exact = now.ask({.region = extent, .tolerance = Metres{tolerance}}).quadtree;
    const RestrictedQuadtree bounded =
        now.ask({.region = extent, .tolerance = Metres{tolerance}, .heights = {.kind = HeightKind::bounded}}).quadtree;
    expect_stream(c, exact, {}, false);
    expect_stream(c, bounded, {}, tolerance == 5);
    std::printf("%s at %g m: %zu vertices, bounded %zu\n", GetParam(), tolerance, exact.vertices.size(),
                bounded.vertices.size());
    EXPECT_LE(static_cast<double>(bounded.vertices.size()), 1.15 * static_cast<double>(exact.vertices.size()));
  }
}

INSTANTIATE_TEST_SUITE_P(Of, StreamsOfRealModels,
                         ::testing::Values("jacksboro", "bigtujunga_30m_utm11.tif", "tirol5m_avaPfa.tif"),
                         [](const auto& about) {
                           std::string name = about.param;
                           for (char& ch : name) ch = std::isalnum(static_cast<unsigned char>(ch)) != 0 ? ch : '_';
                           return name;
                         });

}  // namespace
}  // namespace talus::support
