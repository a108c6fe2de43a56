// Rasters of several tiles: the database is the same however they go through memory.

#include <cmath>
#include <fstream>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "engine/page/manifest.hpp"
#include "engine/tile/tile.hpp"
#include "ingest/job/memory_plan.hpp"
#include "ingest/job/panels.hpp"
#include "storage/page_store.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/inputs.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/random.hpp"
#include "tests/support/random_raster.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/stored_pages.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {
namespace {

namespace fs = std::filesystem;

/// Several tiles wide and high, with voids of all sizes.
Terrain country(int cols, int rows, std::uint64_t seed, SampleType type) {
  Terrain terrain = fractal(cols, rows, seed, 900);
  if (type == SampleType::float32) {
    for (double& h : terrain.values) h = std::round(h * 10) / 10;
  }
  Random random(seed);
  for (int i = 0; i < 40; ++i) {
    const int reach = static_cast<int>(random.log_between(1, 300));
    const int col = random.between(0, cols - 1), row = random.between(0, rows - 1);
    for (int y = std::max(0, row - reach); y < std::min(rows, row + reach); ++y) {
      for (int x = std::max(0, col - reach); x < std::min(cols, col + reach / 2); ++x)
        terrain.valid[static_cast<std::size_t>(y) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(x)] = 0;
    }
  }
  return fit(terrain, type);
}

TEST(Panels, EachSampleIsOneTilesOwnAndEachWindowHoldsItsTiles) {
  const GridRect extent{{-1500, 70}, {2600, 3333}};
  for (const std::int32_t across : {1, 2, 3, 9}) {
    std::int64_t own = 0;
    for (const Panel& panel : panels_of(extent, across)) {
      EXPECT_LE(panel.tiles.size(), static_cast<std::size_t>(across));
      for (const TileId id : panel.tiles) {
        const GridRect window = tile_window(id, extent);
        if (window.cols() <= 0 || window.rows() <= 0) continue;
        EXPECT_TRUE(panel.window.contains(window.first) && panel.window.contains(window.last));
        const GridRect square{
            {std::max(id.x * kTileSide, extent.first.col), std::max(id.y * kTileSide, extent.first.row)},
            {std::min(id.x * kTileSide + kTileSide - 1, extent.last.col),
             std::min(id.y * kTileSide + kTileSide - 1, extent.last.row)}};
        if (square.cols() > 0 && square.rows() > 0) own += square.samples();
      }
    }
    EXPECT_EQ(own, extent.samples());
  }
}

TEST(Stream, ThreadsAndPanelsChangeNoByteOfAnyPage) {
  for (const SampleType type : {SampleType::int16, SampleType::float32}) {
    const TempFolder folder;
    RasterOptions file;
    file.type = type;
    write_raster(country(3300, 2200, 5, type), folder / "a.tif", file);
    const auto made = [&](unsigned threads, std::uint64_t mebibytes) {
      IngestOptions options;
      options.overwrite = true;
      options.threads = threads;
      options.memory_bytes = mebibytes << 20;
      static_cast<void>(ingest(folder / "a.tif", folder / "a.talus", options));
      return pages_of(folder / "a.talus");
    };
    const auto plain = made(1, 4096);
    EXPECT_GT(plain.size(), 300u);
    EXPECT_TRUE(made(2, 4096) == plain) << "two threads";
    EXPECT_TRUE(made(5, 4096) == plain) << "five threads";
    EXPECT_TRUE(made(2, 300) == plain) << "panels one tile wide";
  }
}

TEST(Stream, TooLittleMemoryIsRefusedWithWhatWouldDo) {
  const TempFolder folder;
  write_raster(fit(fractal(50, 40, 1, 100), SampleType::int16), folder / "a.tif");
  IngestOptions options;
  options.memory_bytes = 1 << 20;
  try {
    static_cast<void>(ingest(folder / "a.tif", folder / "a.talus", options));
    ADD_FAILURE() << "took it";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::invalid_argument);
    EXPECT_NE(std::string(failure.what()).find("MiB at least"), std::string::npos) << failure.what();
  }
  EXPECT_FALSE(fs::exists(folder / "a.talus.part"));
}

TEST(Stream, BlocksThatAreReadAsAWholeCountInMemory) {
  const GridRect extent{{0, 0}, {59'999, 59'999}};
  constexpr std::uint64_t kMiB = 1 << 20, kOneBlock = 60'000ull * 60'000 * 2;
  EXPECT_EQ(budget_for(1024 * kMiB, 2, extent, 2, 512 * 512 * 2).threads, 2u);
  const Failure failure = failure_of([&] { static_cast<void>(budget_for(1024 * kMiB, 2, extent, 2, kOneBlock)); });
  EXPECT_EQ(failure.cause(), Cause::invalid_argument);
  EXPECT_NE(std::string(failure.what()).find("blocks of 6866 MiB"), std::string::npos) << failure.what();
}

TEST(Stream, BlocksAreThoseOfTheFilesThatAVirtualRasterJoins) {
  const TempFolder folder;
  write_raster(fit(fractal(700, 40, 1, 100), SampleType::int16), folder / "a.tif");
  std::ofstream(folder / "a.vrt")
      << "<VRTDataset rasterXSize='700' rasterYSize='40'><GeoTransform>0,1,0,40,0,-1</GeoTransform>"
         "<VRTRasterBand dataType='Int16' band='1'><SimpleSource><SourceFilename relativeToVRT='1'>a.tif"
         "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>";
  const std::uint64_t of_tif = open(folder / "a.tif").block_bytes();
  EXPECT_GE(of_tif, 700u * 2);
  EXPECT_EQ(open(folder / "a.vrt").block_bytes(), std::max<std::uint64_t>(of_tif, 128 * 40 * 2));
}

TEST(Stream, MayBeEndedAtEveryStageAndGoneOnWith) {
  const TempFolder folder;
  write_raster(country(1300, 300, 3, SampleType::int16), folder / "a.tif");
  static_cast<void>(ingest(folder / "a.tif", folder / "whole.talus"));
  const auto whole = pages_of(folder / "whole.talus");
  struct Ended {};
  for (const std::string stage : {"levels above tiles", "checking that the inputs are unchanged", "sealing", "done"}) {
    SCOPED_TRACE(stage);
    IngestOptions options;
    options.progress = [&](const IngestProgress& now) {
      if (now.stage == stage) throw Ended{};
    };
    EXPECT_THROW(static_cast<void>(ingest(folder / "a.tif", folder / "a.talus", options)), Ended);
    EXPECT_FALSE(fs::exists(folder / "a.talus"));
    ASSERT_TRUE(fs::exists(folder / "a.talus.part"));
    options.progress = {};
    options.resume = true;
    const IngestReport report = ingest(folder / "a.tif", folder / "a.talus", options);
    EXPECT_EQ(report.tiles, 0u) << "settled again";
    EXPECT_TRUE(pages_of(folder / "a.talus") == whole);
    fs::remove(folder / "a.talus");
  }
}

TEST(Stream, AnswersOverSeveralTilesKeepThePromise) {
  const TempFolder folder;
  for (const SampleType type : {SampleType::int16, SampleType::float32}) {
    const Terrain terrain = country(2300, 1400, 8, type);
    RasterOptions file;
    file.type = type;
    write_raster(terrain, folder / "a.tif", file);
    IngestOptions options;
    options.overwrite = true;
    static_cast<void>(ingest(folder / "a.tif", folder / "a.talus", options));
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    EXPECT_EQ(verify(now, [&](GridRect r) { return Raster(folder / "a.tif").read(r); }).findings,
              std::vector<std::string>{});
    for (const double tolerance : {0.0, 0.5, 3.0, 40.0, 400.0}) {
      for (const GridRect region : {GridRect{{0, 0}, {2299, 1399}}, {{1000, 900}, {1100, 1200}}}) {
        const Mesh mesh = triangulate(now.ask({.region = region, .tolerance = Metres{tolerance}}).quadtree);
        const OracleReport report = check_mesh(mesh, terrain, 1, tolerance, {1, 1});
        EXPECT_TRUE(report.sound()) << tolerance << ": " << report.summary();
      }
    }
  }
}

// ---- later tiles -------------------------------------------------------------------------------------

struct Seen {
  Array<double> heights;
  Array<std::array<std::uint32_t, 3>> triangles;
  friend bool operator==(const Seen&, const Seen&) = default;
};

Seen answer(const fs::path& database, double tolerance) {
  const Mesh mesh = Database::open(database).snapshot().mesh(Metres{tolerance});
  return {mesh.heights, mesh.triangles};
}

/// A part of a terrain as a file in its place.
void write_part(const Terrain& whole, GridRect part, const fs::path& file) {
  RasterOptions options;
  options.geotransform = {static_cast<double>(part.first.col), 1, 0, -static_cast<double>(part.first.row), 0, -1};
  write_raster(
      crop(whole, part.first.col, part.first.row, static_cast<int>(part.cols()), static_cast<int>(part.rows())), file,
      options);
}

TEST(Update, EqualsAnIngestOfEverything) {
  const Terrain whole = country(2600, 1500, 3, SampleType::int16);
  struct Case {
    GridRect before, after;
    const char* what;
  };
  for (const Case& c : {Case{{{0, 0}, {2599, 1499}}, {{700, 300}, {760, 380}}, "a correction in the middle"},
                        Case{{{0, 0}, {1200, 1499}}, {{1201, 0}, {2599, 1499}}, "a tile beside"},
                        Case{{{1100, 900}, {2599, 1499}}, {{0, 0}, {1099, 500}}, "a tile north and west, apart"},
                        Case{{{0, 0}, {900, 900}}, {{100, 100}, {2599, 1400}}, "a larger one over a corner"}}) {
    SCOPED_TRACE(c.what);
    const TempFolder folder;
    write_part(whole, c.before, folder / "before.tif");
    Terrain changed = whole;
    for (double& h : changed.values) h += 7;
    write_part(fit(changed, SampleType::int16), c.after, folder / "after.tif");
    static_cast<void>(ingest(folder / "before.tif", folder / "a.talus"));
    const Snapshot old = Database::open(folder / "a.talus").snapshot();
    const IngestReport updated = update({folder / "after.tif"}, folder / "a.talus");
    static_cast<void>(ingest(std::vector<fs::path>{folder / "before.tif", folder / "after.tif"}, folder / "b.talus"));
    const Snapshot a = Database::open(folder / "a.talus").snapshot(), b = Database::open(folder / "b.talus").snapshot();
    EXPECT_EQ(verify(a).findings, std::vector<std::string>{});
    EXPECT_EQ(a.description().extent.cols(), b.description().extent.cols());
    EXPECT_EQ(a.description().extent.rows(), b.description().extent.rows());
    EXPECT_EQ(a.description().void_samples, b.description().void_samples);
    EXPECT_EQ(a.description().minimum_height, b.description().minimum_height);
    const SampleWindow of_a = a.samples(a.description().extent), of_b = b.samples(b.description().extent);
    EXPECT_EQ(of_a.valid, of_b.valid);
    EXPECT_EQ(of_a.values, of_b.values);
    if (a.description().extent == b.description().extent) {
      for (const double tolerance : {0.0, 2.0, 30.0, 300.0})
        EXPECT_TRUE(answer(folder / "a.talus", tolerance) == answer(folder / "b.talus", tolerance)) << tolerance;
    } else {  // another origin: other triangles, the same promise
      for (const double tolerance : {0.0, 2.0, 30.0, 300.0}) {
        const VerifyReport report = verify(
            a,
            [&](GridRect r) {
              return b.samples(GridRect{
                  {r.first.col - a.description().extent.first.col, r.first.row - a.description().extent.first.row},
                  {r.last.col - a.description().extent.first.col, r.last.row - a.description().extent.first.row}});
            },
            Metres{tolerance});
        EXPECT_EQ(report.findings, std::vector<std::string>{});
        EXPECT_LE(report.true_error->value, tolerance);
      }
    }
    EXPECT_EQ(a.provenance().generation, 1u);
    EXPECT_EQ(a.provenance().sources.size(), 2u);
    EXPECT_EQ(old.description().extent.cols(), c.before.cols()) << "who has the old file keeps it";
    EXPECT_GT(updated.tiles, 0u);
  }
}

TEST(Update, TouchesFewTilesAndSaysSoInGenerations) {
  const Terrain whole = country(4200, 2200, 4, SampleType::int16);
  const TempFolder folder;
  write_part(whole, {{0, 0}, {4199, 2199}}, folder / "before.tif");
  Terrain changed = whole;
  for (double& h : changed.values) h += 1;
  write_part(fit(changed, SampleType::int16), {{2300, 1300}, {2310, 1310}}, folder / "after.tif");
  static_cast<void>(ingest(folder / "before.tif", folder / "a.talus"));
  const IngestReport updated = update({folder / "after.tif"}, folder / "a.talus");
  EXPECT_EQ(updated.tiles, 1u) << "its window holds all that changed";
  const ReadTxn txn(PageStore::open(folder / "a.talus"));
  std::size_t fresh = 0, all = 0;
  for (int table = 0; table < kRecordTable; ++table) {
    txn.for_each(table, [&](std::uint64_t position) {
      ++all;
      fresh += txn.find({table, position})->generation == 1 ? 1 : 0;
    });
  }
  EXPECT_GE(fresh, 3u);
  EXPECT_LE(fresh, 6u) << "of " << all;
}

TEST(Update, DoesNotThrowAwayAnInterruptedIngest) {
  const TempFolder folder;
  write_raster(fit(fractal(50, 40, 1, 100), SampleType::int16), folder / "a.tif");
  static_cast<void>(ingest(folder / "a.tif", folder / "a.talus"));
  {
    PageWriter interrupted(folder / "a.talus.part");
    const std::string plan = "talus format 3\n";
    interrupted.put({kHeaderTable, kPlanPosition}, std::as_bytes(std::span(plan)));
    interrupted.put({kRecordTable, 3}, {});
    interrupted.commit(true);
  }
  const auto left = pages_of(folder / "a.talus.part");
  EXPECT_THROW(static_cast<void>(update({folder / "a.tif"}, folder / "a.talus")), Failure);
  EXPECT_TRUE(pages_of(folder / "a.talus.part") == left);
}

TEST(Update, WhatIsNoDatabaseIsLeftAlone) {
  const TempFolder folder;
  write_raster(fit(fractal(50, 40, 1, 100), SampleType::int16), folder / "a.tif");
  EXPECT_THROW(static_cast<void>(update({folder / "a.tif"}, folder / "none.talus")), Failure);
  const auto bytes = fs::file_size(folder / "a.tif");
  EXPECT_THROW(static_cast<void>(update({folder / "a.tif"}, folder / "a.tif")), Failure);
  EXPECT_EQ(fs::file_size(folder / "a.tif"), bytes);
}

}  // namespace
}  // namespace talus::support
