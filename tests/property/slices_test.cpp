// Answers from slices are those from pages.

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "query/accuracy/true_error.hpp"
#include "query/snapshot_view.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/forged_database.hpp"
#include "tests/support/quadtrees.hpp"
#include "tests/support/random_raster.hpp"
#include "tests/support/real_models.hpp"

namespace talus::support {
namespace {

/// The same database, but its slices hold nothing. Returns their thresholds, in metres.
std::vector<double> write_without_slices(const std::filesystem::path& database, const std::filesystem::path& without) {
  Forgery forged(database);
  const std::vector<double> thresholds = forged.empty_slices();
  forged.write(without);
  return thresholds;
}

std::uint64_t from_slices(const QueryCost& cost) {
  std::uint64_t count = 0;
  for (const BandCost& band : cost.bands) count += band.from_slice;
  return count;
}

/// Pages that slices replaced. The bounds may differ: pages count more of what lies outside the region,
/// slices what they leave out as their threshold.
std::uint64_t expect_same(const Question& question, const Snapshot& with, const Snapshot& without) {
  Answer a = with.ask(question), b = without.ask(question);
  EXPECT_EQ(from_slices(b.cost), 0u);
  EXPECT_EQ(a.border_vertices, b.border_vertices);
  const double rounding = 1e-9;
  EXPECT_LE(a.quadtree.bound.value, std::max(b.quadtree.bound.value, question.tolerance.value + rounding));
  b.quadtree.bound = a.quadtree.bound;
  EXPECT_EQ(difference(a.quadtree, b.quadtree), "");
  return from_slices(a.cost);
}

TEST(Slices, GiveTheAnswersOfPages) {
  const SizeLimits limits{.least_cols = 1, .least_rows = 1, .most_cols = 1400, .most_rows = 300};
  std::uint64_t replaced = 0;
  const auto one = property_seed();
  const auto cases = one ? std::uint64_t{1} : static_cast<std::uint64_t>(property_cases(300));
  const std::uint64_t first = one.value_or(73000);
  for (std::uint64_t seed = first; seed < first + cases; ++seed) {
    const RandomRaster raster = random_raster(seed, limits);
    SCOPED_TRACE(raster.description);
    const TempFolder folder;
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    IngestOptions options;
    options.void_weight = raster.void_weight;
    ingest(folder / "a.tif", folder / "a.talus", options);
    const auto thresholds = write_without_slices(folder / "a.talus", folder / "b.talus");
    const Snapshot with = Database::open(folder / "a.talus", {.threads = 2}).snapshot();
    const Snapshot without = Database::open(folder / "b.talus", {.threads = 1}).snapshot();
    Random random(seed);
    for (int i = 0; i < 6; ++i) {
      const bool is_near = random.chance(0.8) && !thresholds.empty();  // most others are below or above all of a slice
      const double tolerance = is_near ? thresholds[static_cast<std::size_t>(random.next() % thresholds.size())] *
                                             (random.chance(0.3) ? 1 : random.within(0.98, 1.5))
                                       : random_tolerance(random);
      Question question{.region = random_region(random, raster.terrain), .tolerance = Metres{tolerance}};
      replaced += expect_same(question, with, without);
      if (tolerance == 0 || tolerance > 1e9 || random.chance(0.5)) continue;
      question.from = Metres{tolerance * random.within(1.01, 5)};
      replaced += expect_same(question, with, without);
    }
    if (HasFailure()) return;
  }
  EXPECT_TRUE(one || 3 * replaced > cases) << replaced << ": slices were hardly ever used";
}

/// Where codes of errors are no eighths, and where heights are too far apart for eighths in a page. The slices must be
/// those of their pages, and answers keep the promise whoever asks for them.
TEST(Slices, OfFeetAndOfOddStepsHoldWhatPagesHold) {
  struct Way {
    const char* name;
    double cliff;
    IngestOptions options;
  };
  std::vector<Way> ways(5, {"", 0, {}});
  ways[0].name = "feet", ways[0].options.inputs.vertical_unit = VerticalUnit::foot;
  ways[1].name = "steps of 7 m", ways[1].options.inputs.height_step = Metres{7};
  ways[2].name = "perpendicular steps of 7 m", ways[2].options.inputs.height_step = Metres{7};
  ways[2].options.error_metric = ErrorMetric::perpendicular;
  // More than 2^24 codes apart in a page, and still on the ladder of errors.
  ways[3].name = "steps of three thousandths of a millimetre", ways[3].options.inputs.height_step = Metres{3e-6};
  ways[4].name = "cliffs of 400 km in centimetres", ways[4].cliff = 4e7;
  ways[4].options.inputs.vertical_unit = VerticalUnit::centimetre;
  for (const Way& way : ways) {
    SCOPED_TRACE(way.name);
    Terrain terrain = fit(fractal(1100, 400, 8, 900), SampleType::int32);
    Random random(3);
    for (int i = 0; i < 150; ++i) terrain.at(random.between(0, 1099), random.between(0, 399)) += 250;  // spikes
    for (int row = 100; way.cliff > 0 && row < 120; ++row) {
      for (int col = 500; col < 520; ++col) terrain.at(col, row) += way.cliff;
    }
    const TempFolder folder;
    write_raster(terrain, folder / "a.tif", {});
    ingest(folder / "a.tif", folder / "a.talus", way.options);
    EXPECT_EQ(write_without_slices(folder / "a.talus", folder / "b.talus").size(), 2u) << "no slice holds nothing";
    const Database database = Database::open(folder / "a.talus");
    EXPECT_EQ(verify(database.snapshot()).findings, std::vector<std::string>());
    const Snapshot with = database.snapshot(), without = Database::open(folder / "b.talus").snapshot();
    const GridRect extent = with.description().extent;
    std::uint64_t replaced = 0;
    for (const double tolerance : {400.0, 200.0, 100.0, 50.0, 20.0, 10.0, 9.99, 5.0, 3.0, 1.0, 0.5, 0.2, 0.1}) {
      Question question{.region = extent, .tolerance = Metres{tolerance}};
      replaced += expect_same(question, with, without);
      const Answer answer = with.ask(question);
      // A field that is the same everywhere selects the same vertices.
      Question field = question;
      field.field = patch_tolerance(extent, 1, 1, {tolerance});
      EXPECT_EQ(with.ask(field).quadtree.vertices.size(), answer.quadtree.vertices.size()) << tolerance;
      const auto truth = [&](GridRect strip) { return with.samples(strip); };
      const double error = true_error(triangulate(answer.quadtree), with.description(), truth).largest_m;
      const bool is_vertical = with.description().error_metric == ErrorMetric::vertical;
      EXPECT_TRUE(!is_vertical || error <= answer.quadtree.bound.value + 1e-9) << error << " m at " << tolerance;
      question.from = Metres{2 * tolerance};
      replaced += expect_same(question, with, without);
    }
    EXPECT_GT(replaced, 3u);
  }
}

/// Ten metres are no whole eighths of a foot: an error stored as just 10 m counts as more than the tolerance. It is the
/// largest one of its page.
TEST(Slices, HaveVerticesWhoseCodeIsTheThreshold) {
  Random random(1);
  Terrain terrain = fit(fractal(1100, 1100, 1, 0), SampleType::int16);
  for (int row = 0; row < 1100; ++row) {
    for (int col = 0; col < 1100; ++col) {
      const bool is_calm = col >= 200 && col <= 560 && row >= 200 && row <= 560;
      terrain.at(col, row) = row < 1024 && col < 1024 && !is_calm && random.chance(0.02) ? 20 : 0;
    }
  }
  terrain.at(384, 400) = 1, terrain.at(384, 402) = 1, terrain.at(383, 402) = 33;
  const TempFolder folder;
  write_raster(terrain, folder / "a.tif", {});
  IngestOptions options;
  options.inputs.vertical_unit = VerticalUnit::foot;
  ingest(folder / "a.tif", folder / "a.talus", options);
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  EXPECT_EQ(verify(now).findings, std::vector<std::string>());
  // Nor may a field of tolerance leave out the page.
  Question question{.region = now.description().extent, .tolerance = Metres{10}};
  const std::size_t plain = now.ask(question).quadtree.vertices.size();
  question.field = patch_tolerance(now.description().extent, 1, 1, {10.0});
  EXPECT_EQ(now.ask(question).quadtree.vertices.size(), plain);
}

TEST(Slices, GiveTheAnswersOfPagesOfRealModels) {
  for (const char* name : {"srtm3_N46E008.tif", "kenya_central_z11.tif", "gabilan.bil"}) {
    SCOPED_TRACE(name);
    const TempFolder folder;
    const RealModel model = real_model(name, folder);
    if (!model.file) GTEST_SKIP() << model.why_not;
    ingest(*model.file, folder / "a.talus");
    static_cast<void>(write_without_slices(folder / "a.talus", folder / "b.talus"));
    const Snapshot with = Database::open(folder / "a.talus").snapshot();
    const Snapshot without = Database::open(folder / "b.talus").snapshot();
    const GridRect extent = with.description().extent;
    Random random(5);
    std::uint64_t replaced = 0;
    for (const double tolerance : {2000.0, 1000.0, 437.3, 200.0, 100.0, 50.0, 21.7, 10.0, 2.0, 1.0}) {
      replaced += expect_same({.region = extent, .tolerance = Metres{tolerance}}, with, without);
      const GridPoint first{random.between(extent.first.col, extent.last.col - 500),
                            random.between(extent.first.row, extent.last.row - 500)};
      const GridRect region{first,
                            {std::min(first.col + 1500, extent.last.col), std::min(first.row + 1200, extent.last.row)}};
      replaced += expect_same({.region = region, .tolerance = Metres{tolerance}}, with, without);
      replaced +=
          expect_same({.region = region, .tolerance = Metres{tolerance}, .from = Metres{3 * tolerance}}, with, without);
    }
    EXPECT_GT(replaced, 0u);
  }
}

/// A finer question does not read the slice in vain, and a much coarser one takes the few pages that it needs.
TEST(Slices, AreReadWhereTheyAreWorthIt) {
  const TempFolder folder;
  Terrain terrain = fit(fractal(1024, 1024, 5, 2000), SampleType::int16);
  terrain.at(500, 501) += 20000;  // above every tolerance asked for
  write_raster(terrain, folder / "a.tif");
  ingest(folder / "a.tif", folder / "a.talus");
  const std::vector<double> thresholds = write_without_slices(folder / "a.talus", folder / "b.talus");
  ASSERT_EQ(thresholds.size(), 1u);
  const Snapshot now = Database::open(folder / "a.talus", {.cache_bytes = 0, .threads = 1}).snapshot();
  const auto slices_read = [&](double tolerance) {
    std::uint64_t read = 0;
    for (const BandCost& band :
         now.ask({.region = now.description().extent, .tolerance = Metres{tolerance}}).cost.bands)
      read += band.slices_read;
    return read;
  };
  EXPECT_EQ(slices_read(0.9 * thresholds[0]), 0u);
  EXPECT_EQ(slices_read(thresholds[0]), 1u);
  EXPECT_EQ(slices_read(2 * thresholds[0]), 1u);
  EXPECT_EQ(slices_read(17 * thresholds[0]), 0u);
}

}  // namespace
}  // namespace talus::support
