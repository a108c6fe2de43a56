// What verify finds in databases whose every checksum fits: each is damaged in one way and no other.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "engine/page/tile_slice.hpp"
#include "engine/quadtree/border.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/forged_database.hpp"
#include "tests/support/random.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {
namespace {

/// Two tiles and a little of two more, with lakes of void; made once.
class ForgedDatabase : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new TempFolder;
    Terrain terrain = void_blobs(fit(fractal(1300, 300, 4, 600), SampleType::int16), 3, 7);
    for (int row = 100; row < 179; ++row) {  // far from data: fills of coarse vertices are found here
      for (int col = 380; col < 640; ++col) terrain.make_void(col, row);
    }
    RasterOptions options;
    options.geotransform = {500000, 10, 0, 5600400, 0, -10};
    write_raster(terrain, *folder / "a.tif", options);
    ingest(*folder / "a.tif", *folder / "a.talus");
    Terrain more = fit(fractal(150, 120, 9, 600), SampleType::int16);
    options.geotransform = {501000, 10, 0, 5600000, 0, -10};
    write_raster(more, *folder / "more.tif", options);
    std::filesystem::copy_file(*folder / "a.talus", *folder / "updated.talus");
    update({*folder / "more.tif"}, *folder / "updated.talus");
  }
  static void TearDownTestSuite() { delete folder; }

  /// With pages that can be changed alone.
  static Forgery forgery_of(const char* name) { return Forgery(*folder / name, Forgery::Corners::in_each_page); }

  static VerifyReport verified(const Forgery& forgery) {
    forgery.write(*folder / "forged.talus");
    return verify(Database::open(*folder / "forged.talus").snapshot());
  }
  /// Found, and in a rectangle with this sample.
  static void expect_found(const Forgery& forgery, const std::string& word, std::optional<GridPoint> at = {}) {
    const VerifyReport report = verified(forgery);
    ASSERT_TRUE(report.is_damaged());
    EXPECT_TRUE(std::any_of(report.findings.begin(), report.findings.end(), [&](const std::string& f) {
      return f.find(word) != std::string::npos;
    })) << report.findings.front();
    if (!at) return;
    EXPECT_TRUE(report.is_rest_usable) << report.findings.front();
    EXPECT_TRUE(std::any_of(report.damaged.begin(), report.damaged.end(),
                            [&](const DamagedPart& d) { return d.samples.contains(*at); }));
    const GridMapping m{500005, 5600395, 10, -10};
    for (const DamagedPart& d : report.damaged) {
      EXPECT_DOUBLE_EQ(d.rectangle.xmin, m.x(d.samples.first.col));
      EXPECT_DOUBLE_EQ(d.rectangle.ymin, m.y(d.samples.last.row));
      EXPECT_DOUBLE_EQ(d.rectangle.xmax, m.x(d.samples.last.col));
      EXPECT_DOUBLE_EQ(d.rectangle.ymax, m.y(d.samples.first.row));
    }
  }
  static std::size_t index(const Page& page, GridPoint p) {
    return page.index((p.col >> page.grid.shift) - page.grid.first.col,
                      (p.row >> page.grid.shift) - page.grid.first.row);
  }
  /// An own vertex of a page for which something holds.
  static GridPoint own_vertex(const Page& page, const std::function<bool(std::size_t, GridPoint)>& holds) {
    for (std::int32_t row = 0; row < page.grid.rows; ++row) {
      for (std::int32_t col = 0; col < page.grid.cols; ++col) {
        const GridPoint p = page.grid.at(col, row);
        if (page.is_own(p) && spacing(p) != kRootSpacing && holds(page.index(col, row), p)) return p;
      }
    }
    throw std::runtime_error("the test's database has no such vertex");
  }

  static TempFolder* folder;
};
TempFolder* ForgedDatabase::folder = nullptr;

TEST_F(ForgedDatabase, IsSoundAsItWasMade) {
  for (const char* name : {"a.talus", "updated.talus"}) {
    Forgery same(*folder / name);
    EXPECT_EQ(verified(same).findings, std::vector<std::string>());
    same.hide();
    EXPECT_EQ(verified(same).findings, std::vector<std::string>()) << "hiding nothing changes nothing";
  }
}

TEST_F(ForgedDatabase, ARepeatedHeightOfAFinePageIsFound) {
  Forgery forged = forgery_of("a.talus");
  Page page = forged.page({0, 1, 1});
  page.heights[index(page, {136, 136})] += 1;  // every 8th column and row stands in the page above, too
  forged.put(page);
  forged.hide();
  expect_found(forged, "column 136, row 136", GridPoint{136, 136});
}

TEST_F(ForgedDatabase, ARepeatedHeightOfACoarsePageIsFound) {
  for (const int band : {1, 2}) {
    Forgery forged = forgery_of("a.talus");
    Page page = forged.page({band, 0, 0});
    page.heights[index(page, {192, 64})] += 1;
    forged.put(page);
    forged.hide();
    expect_found(forged, "column 192, row 64", GridPoint{192, 64});
  }
}

TEST_F(ForgedDatabase, AnyOtherHeightOfAFinePageIsFound) {
  Forgery forged = forgery_of("a.talus");
  Page page = forged.page({0, 1, 1});
  page.heights[index(page, {133, 141})] += 40;
  forged.put(page);
  forged.hide();
  expect_found(forged, "error", GridPoint{133, 141});
}

TEST_F(ForgedDatabase, AnErrorBelowThatOfAVertexInAnotherPageIsFound) {
  // A vertex of band 1 that a vertex of band 0 depends on.
  Forgery forged = forgery_of("a.talus");
  const Page fine = forged.page({0, 1, 1});
  GridPoint parent{};
  own_vertex(fine, [&](std::size_t i, GridPoint p) {
    parent = diamond(p).apexes[0];
    return fine.errors[i] > 0 && band_of(parent, 3) == 1 && page_square({1, 0, 0}).contains(parent);
  });
  Page coarse = forged.page({1, 0, 0});
  coarse.errors[index(coarse, parent)] = 0;
  forged.put(coarse);
  forged.hide();
  expect_found(forged, "is below", parent);
}

TEST_F(ForgedDatabase, AnErrorBelowThatOfAVertexBesideThePageIsFound) {
  // The neighbour's outermost vertices depend on the first column of this page.
  Forgery forged = forgery_of("a.talus");
  const Page west = forged.page({0, 0, 1});
  GridPoint parent{};
  own_vertex(west, [&](std::size_t i, GridPoint p) {
    parent = diamond(p).apexes[1];
    return p.col == 127 && west.errors[i] > 0 && parent.col == 128 && band_of(parent, 3) == 0;
  });
  Page east = forged.page({0, 1, 1});
  east.errors[index(east, parent)] = 0;
  forged.put(east);
  forged.hide();
  expect_found(forged, "is below", parent);
}

TEST_F(ForgedDatabase, AnErrorThatNothingDependsOnIsFoundLoweredOrRaised) {
  for (const int by : {-1, 1}) {
    Forgery forged = forgery_of("a.talus");
    Page page = forged.page({0, 2, 0});
    const GridPoint p = own_vertex(
        page, [&](std::size_t i, GridPoint v) { return spacing(v) == 1 && !is_centre(v) && page.errors[i] > 3; });
    page.errors[index(page, p)] = static_cast<ErrorCode>(page.errors[index(page, p)] + by);
    forged.put(page);
    forged.hide();
    expect_found(forged, "error", p);
  }
}

TEST_F(ForgedDatabase, ACoarseErrorThatIsTooLowIsFound) {
  Forgery forged = forgery_of("a.talus");
  Page page = forged.page({2, 0, 0});
  const GridPoint p =
      own_vertex(page, [&](std::size_t i, GridPoint v) { return spacing(v) == 64 && page.errors[i] > 3; });
  --page.errors[index(page, p)];
  forged.put(page);
  forged.hide();
  expect_found(forged, "", p);
}

TEST_F(ForgedDatabase, AnErrorInAPagesTableOfPagesBelowIsFound) {
  for (const int by : {-1, 1}) {
    Forgery forged = forgery_of("a.talus");
    Page page = forged.page({1, 0, 0});
    page.children[9].largest = static_cast<ErrorCode>(page.children[9].largest + by);
    forged.put(page);
    expect_found(forged, "largest error", GridPoint{130, 130});
  }
}

TEST_F(ForgedDatabase, ARecordOfAnotherTileIsFound) {
  Forgery forged = forgery_of("a.talus");
  TileSummary record = forged.record(1, 0);
  record.entry = forged.record(0, 0).entry;
  forged.put(0, 0, record);
  expect_found(forged, "record of tile 0/0", GridPoint{0, 0});
}

TEST_F(ForgedDatabase, ARecordThatSaysSomethingElseIsFound) {
  const std::vector<std::function<void(TileSummary&)>> changes{
      [](TileSummary& r) { r.posts[17] += 1; },
      [](TileSummary& r) { r.post_valid[17] ^= 1; },
      [](TileSummary& r) { ++r.valid_samples; },
      [](TileSummary& r) { r.lowest -= 1; },
      [](TileSummary& r) { r.errors[3] += 1; },
      [](TileSummary& r) { r.record.errors[20] = static_cast<ErrorCode>(r.record.errors[20] + 1); },
      [](TileSummary& r) { r.record.blocks[5].above += 1; },
      [](TileSummary& r) { r.record.blocks[5].holds ^= 1; },
      [](TileSummary& r) { r.record.holds[20] ^= 2; },
      [](TileSummary& r) { r.entry.largest = 7; },
      [](TileSummary& r) { r.entry.generation = 3; },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    SCOPED_TRACE(i);
    Forgery forged = forgery_of("a.talus");
    TileSummary record = forged.record(0, 0);
    changes[i](record);
    forged.put(0, 0, record);
    expect_found(forged, "record of tile 0/0", GridPoint{0, 0});
  }
  Forgery without = forgery_of("a.talus");
  without.stored.erase({kRecordTable, curve_position({1, 0, 0})});
  expect_found(without, "record of tile 0/0: missing", GridPoint{0, 0});
  Forgery beyond = forgery_of("a.talus");
  beyond.put(7, 7, beyond.record(0, 0));
  expect_found(beyond, "its tile has a record");
}

TEST_F(ForgedDatabase, APageOfAnOlderGenerationIsFound) {
  // As after an update that did not reach this page, once as it is and once with everything above made to fit.
  const Forgery before = forgery_of("a.talus"), after = forgery_of("updated.talus");
  for (const PageId id : {PageId{0, 1, 1}, PageId{1, 0, 0}, PageId{2, 0, 0}}) {
    for (const bool is_hidden : {false, true}) {
      Forgery forged = after;
      forged.stored[Forgery::key(id)] = before.stored.at(Forgery::key(id));
      if (is_hidden) forged.hide();
      expect_found(forged, "", GridPoint{130, 130});
    }
  }
}

TEST_F(ForgedDatabase, AGenerationOfTheHeaderIsFound) {
  Forgery forged = forgery_of("updated.talus");
  Manifest m = forged.manifest();
  m.top_generations[0] = 0;
  forged.put(m);
  expect_found(forged, "the header says 0", GridPoint{0, 0});
}

TEST_F(ForgedDatabase, AnEntryOfAPageBelowThatWasDroppedIsFound) {
  Forgery forged = forgery_of("a.talus");
  Page page = forged.page({1, 0, 0});
  page.children[9] = {};
  forged.put(page);
  expect_found(forged, "unknown to the page above it", GridPoint{130, 130});
  // The page, too, and all that is said above of it.
  forged = forgery_of("a.talus");
  forged.stored.erase(Forgery::key({0, 1, 1}));
  forged.hide();
  expect_found(forged, "not stored", GridPoint{130, 130});
}

TEST_F(ForgedDatabase, AVoidBitIsFound) {
  for (const bool was_void : {false, true}) {
    Forgery forged = forgery_of("a.talus");
    Page page = forged.page({0, 3, 1});
    ASSERT_FALSE(page.valid.empty());
    const GridPoint p = own_vertex(page, [&](std::size_t i, GridPoint) { return (page.valid[i] == 0) == was_void; });
    page.valid[index(page, p)] ^= 1;
    forged.put(page);
    forged.hide();
    expect_found(forged, "", p);
  }
}

TEST_F(ForgedDatabase, ATriangleWithDataIsFound) {
  Forgery forged = forgery_of("a.talus");
  Page page = forged.page({0, 3, 1});
  const GridPoint p = own_vertex(page, [&](std::size_t i, GridPoint) { return page.covers[i] == 0; });
  page.covers[index(page, p)] = 15;
  forged.put(page);
  forged.hide();
  expect_found(forged, "triangle", p);
}

TEST_F(ForgedDatabase, AFillIsFound) {
  for (const PageId id : {PageId{0, 3, 1}, PageId{1, 0, 0}, PageId{2, 0, 0}}) {
    SCOPED_TRACE(id.band);
    Forgery forged = forgery_of("a.talus");
    Page page = forged.page(id);
    ASSERT_FALSE(page.valid.empty());
    const GridPoint p =
        own_vertex(page, [&](std::size_t i, GridPoint) { return page.valid[i] == 0 && page.covers[i] != 0; });
    page.heights[index(page, p)] += 1;
    forged.put(page);
    forged.hide();
    expect_found(forged, "fill", p);
  }
}

/// Which of two zeros is the lowest height depends on the order of samples; a record does not.
TEST(Verify, ZerosOfBothSignsAmidVoidsAreSound) {
  const TempFolder folder;
  Terrain terrain(129, 3);
  std::fill(terrain.valid.begin(), terrain.valid.end(), 0);
  for (const auto& [col, row, height] : {std::tuple{128, 0, -0.0}, {127, 2, 0.0}}) {
    terrain.at(col, row) = height;
    terrain.valid[terrain.index(col, row)] = 1;
  }
  RasterOptions options;
  options.type = SampleType::float32;
  write_raster(terrain, folder / "a.tif", options);
  ingest(folder / "a.tif", folder / "a.talus");
  EXPECT_EQ(verify(Database::open(folder / "a.talus").snapshot()).findings, std::vector<std::string>());
}

/// A page of band 0 has a check of the heights that it takes from the page above.
TEST_F(ForgedDatabase, AnotherPageAboveIsFoundAndRefused) {
  Forgery forged(*folder / "a.talus", Forgery::Corners::as_stored);
  Page above = forged.page({1, 0, 0});
  above.heights[above.index({160, 24})] += 1;  // in page 1/0
  forged.put(above);
  expect_found(forged, "another page above it", GridPoint{160, 24});
  const Snapshot now = Database::open(*folder / "forged.talus").snapshot();
  try {
    static_cast<void>(now.samples({{150, 20}, {170, 30}}));
    FAIL() << "it was read";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::corrupt) << failure.what();
  }
  EXPECT_EQ(now.samples({{0, 0}, {100, 100}}).values.size(), 101u * 101u) << "other pages are as they were";
}

TEST_F(ForgedDatabase, APageWithAnothersContentIsFound) {
  Forgery forged = forgery_of("a.talus");
  std::swap(forged.stored.at(Forgery::key({0, 0, 0})), forged.stored.at(Forgery::key({0, 1, 0})));
  forged.hide();
  expect_found(forged, "", GridPoint{0, 0});
}

TEST_F(ForgedDatabase, AHeaderThatSaysSomethingElseIsFound) {
  const std::vector<std::pair<std::string, std::function<void(Manifest&)>>> changes{
      {"minimum", [](Manifest& m) { m.description.minimum_height -= 1; }},
      {"maximum", [](Manifest& m) { m.description.maximum_height += 1; }},
      {"void samples", [](Manifest& m) { ++m.description.void_samples; }},
      {"extent, last column", [](Manifest& m) { --m.description.extent.last.col; }},
      {"extent, first row", [](Manifest& m) { --m.description.extent.first.row; }},
      {"extent, last row", [](Manifest& m) { ++m.description.extent.last.row; }},
      {"scale", [](Manifest& m) { m.description.step.scale = 2; }},
      {"offset", [](Manifest& m) { m.description.step.offset = 1; }},
      {"unit", [](Manifest& m) { m.description.metres_per_unit = 0.3048; }},
      {"void weight", [](Manifest& m) { m.description.void_weight = 0.5; }},
      {"metric", [](Manifest& m) { m.description.error_metric = ErrorMetric::perpendicular; }},
      {"cells", [](Manifest& m) { m.description.mapping.dx = 20; }},
      {"generation", [](Manifest& m) { m.generation = 4; }},
  };
  for (const auto& [name, change] : changes) {
    SCOPED_TRACE(name);
    Forgery forged = forgery_of("a.talus");
    Manifest m = forged.manifest();
    change(m);
    forged.put(m);
    try {
      EXPECT_TRUE(verified(forged).is_damaged());
    } catch (const Failure& f) {
      EXPECT_EQ(f.cause(), Cause::corrupt) << f.what();
    }
  }
}

TEST_F(ForgedDatabase, CountsOfTheProvenanceAreFound) {
  Forgery forged = forgery_of("a.talus");
  Provenance p = forged.provenance();
  p.vertices_above[4].second += 1;
  forged.put(p);
  const VerifyReport report = verified(forged);
  EXPECT_TRUE(report.is_damaged());
  EXPECT_TRUE(report.is_rest_usable) << "no answer needs it";
}

/// What a query says of a database; empty: it refuses it.
std::optional<std::pair<Mesh, SampleWindow>> seen(const std::filesystem::path& file) {
  try {
    const Snapshot now = Database::open(file).snapshot();
    const Mesh rough = now.mesh(Metres{3});
    return std::pair{now.mesh(Metres{0}), now.samples(now.description().extent)};
  } catch (const Failure&) {
    return std::nullopt;
  }
}

TEST_F(ForgedDatabase, ASliceThatIsNotThatOfItsPagesIsFound) {
  const Forgery sound = forgery_of("a.talus");
  const Manifest m = sound.manifest();
  const CodeDistance distance(m.description);
  SliceCoder coder;
  const PageKey key{kSliceTable, curve_position({1, 0, 0})};
  const TileSlice slice = coder.decode({0, 0}, m.description.extent, distance, sound.stored.at(key).content);
  ASSERT_GT(slice.size(), 20u);
  std::size_t last = 0;  // no vertex depends on it
  for (std::size_t i = 0; i < slice.size(); ++i) {
    if (slice.errors[i] < slice.errors[last] && slice.errors[i] > slice.above) last = i;
  }
  const auto with = [&](auto&& change) {
    Forgery forged = sound;
    TileSlice changed = slice;
    change(changed);
    forged.stored.at(key).content = SliceCoder().encode({0, 0}, m.description.extent, distance, changed);
    EXPECT_NE(forged.stored.at(key).content, sound.stored.at(key).content);
    return forged;
  };
  expect_found(with([&](TileSlice& s) { s.heights[5] += 1; }), "slice of tile 0/0: the height");
  expect_found(with([&](TileSlice& s) { s.errors[last] += 1; }), "slice of tile 0/0: the error");
  const auto of_none = [](std::int32_t above) {
    TileSlice none;
    none.above = above;
    return none;
  };
  const auto with_covers = [](TileSlice& s) {
    s.covers.assign(s.size(), 15);
    s.covers[3] = 7;
  };
  expect_found(with(with_covers), "slice of tile 0/0: the triangles around the vertex", GridPoint{500, 100});
  expect_found(with([&](TileSlice& s) { s = of_none(s.above); }), "slice of tile 0/0: the vertex");
  EXPECT_EQ(verified(with([&](TileSlice& s) { s = of_none(kNoSlice); })).findings, std::vector<std::string>())
      << "slower, but not wrong";

  Forgery without = sound;
  without.stored.erase(key);
  expect_found(without, "slice of tile 0/0: missing");
  Forgery other = sound;
  other.stored.at(key).generation = 1;
  expect_found(other, "slice of tile 0/0: written by update 1, but its tile by update 0");
  Forgery more = sound;
  more.stored[{kSliceTable, curve_position({1, 77, 0})}] = more.stored.at(key);
  expect_found(more, "slice of tile 77/0: unknown");
}

/// In a database that keeps the vertices of a tolerance, pages are read from the slice, so only the slice can be wrong.
TEST_F(ForgedDatabase, ASliceThatIsAllThatItsTileHasIsChecked) {
  Terrain terrain = void_blobs(fit(fractal(900, 700, 4, 600), SampleType::int16), 3, 7);
  write_raster(terrain, *folder / "kept.tif");
  IngestOptions options;
  options.finest_tolerance = Metres{20};
  ingest(*folder / "kept.tif", *folder / "kept.talus", options);
  const Forgery sound(*folder / "kept.talus");
  EXPECT_EQ(verified(sound).findings, std::vector<std::string>());
  const GridRect extent = sound.manifest().description.extent;
  const CodeDistance distance(sound.manifest().description);
  const PageKey key{kSliceTable, curve_position({1, 0, 0})};
  ASSERT_TRUE(sound.stored.contains(key)) << "few vertices of this ground are above 20 m";
  SliceCoder coder;
  const TileSlice slice = coder.decode({0, 0}, extent, distance, sound.stored.at(key).content);
  const std::set<std::uint32_t> places(slice.places.begin(), slice.places.end());
  const auto point = [&](std::size_t i) {
    return GridPoint{static_cast<std::int32_t>(slice.places[i] % kTileSide),
                     static_cast<std::int32_t>(slice.places[i] / kTileSide)};
  };
  const auto with = [&](auto&& change, bool is_sound_elsewhere = false) {
    Forgery forged = sound;
    TileSlice changed = slice;
    change(changed);
    forged.stored.at(key).content = SliceCoder().encode({0, 0}, extent, distance, changed);
    EXPECT_NE(forged.stored.at(key).content, sound.stored.at(key).content);
    for (const auto& [at, any] : sound.stored) {
      if (at.table == 0 || at.table == 1) forged.put(sound.page(page_at(at.table, at.position)));
    }
    if (is_sound_elsewhere) forged.hide();
    return forged;
  };
  const auto remove = [](TileSlice& s, std::size_t i) {
    const auto at = static_cast<std::ptrdiff_t>(i);
    s.places.erase(s.places.begin() + at);
    s.heights.erase(s.heights.begin() + at);
    s.errors.erase(s.errors.begin() + at);
    if (!s.covers.empty()) s.covers.erase(s.covers.begin() + at);
  };
  const auto first_where = [&](auto&& is) {
    std::size_t i = 0;
    while (i < slice.size() && !is(i)) ++i;
    EXPECT_LT(i, slice.size());
    return std::min(i, slice.size() - 1);
  };
  const std::size_t beside = first_where([&](std::size_t i) {
    return spacing(point(i)) == 1 && slice.errors[i] == slice.above && is_near_border(point(i), extent) &&
           terrain.is_valid(point(i).col, point(i).row);
  });
  const std::size_t least = first_where([&](std::size_t i) {  // no vertex depends on it
    const Children below = children(point(i));
    const bool is_leaf = std::none_of(below.at.begin(), below.at.begin() + below.count,
                                      [&](GridPoint p) { return places.contains(place_in_tile(p)); });
    return is_leaf && slice.errors[i] > slice.above && !is_near_border(point(i), extent);
  });
  expect_found(with([&](TileSlice& s) { remove(s, beside); }), "a height near the border is missing");
  expect_found(with([&](TileSlice& s) { remove(s, least); }), "counts of errors differ");
  const auto lower = [](TileSlice& s) {
    s.above -= 100;
    std::replace(s.errors.begin(), s.errors.end(), s.above + 100, s.above);
  };
  expect_found(with(lower, true), "its threshold is not the tolerance");
  expect_found(with([&](TileSlice& s) { s.errors[least] = kAlwaysSelected - 1; }), "below the");
  const auto add_one = [&](TileSlice& s) {  // below a vertex of spacing 32, amid the tile
    const std::size_t of = first_where([&](std::size_t i) {
      return spacing(point(i)) == 32 && !is_near_border(point(i), extent) && is_centre(point(i));
    });
    for (std::size_t i = of; i < slice.size() && s.size() == slice.size(); ++i) {
      const Children below = children(point(i));
      for (int k = 0; k < below.count && s.size() == slice.size(); ++k) {
        const GridPoint p = below.at[static_cast<std::size_t>(k)];
        const auto apexes = diamond(p).apexes;
        const bool has_parents = std::all_of(apexes.begin(), apexes.end(), [&](GridPoint q) {
          return spacing(q) >= kBlockSide || places.contains(place_in_tile(q));
        });
        if (!has_parents || is_near_border(p, extent) || places.contains(place_in_tile(p))) continue;
        s.places.push_back(place_in_tile(p));
        s.heights.push_back(1000);
        s.errors.push_back(s.above);
        if (!s.covers.empty()) s.covers.push_back(15);
      }
    }
  };
  expect_found(with(add_one), "vertices, but its pages have");

  Forgery other = sound;  // checksums fit, but the pages are of another slice
  const std::vector<std::byte> whole = sound.stored.at(key).content;
  TileSlice changed = slice;
  changed.heights[5] += 1;
  other.stored.at(key).content = SliceCoder().encode({0, 0}, extent, distance, changed);
  expect_found(other, "it was written beside another slice");
  Forgery without = sound;
  without.stored.erase(key);
  expect_found(without, "the slice of its tile is missing");
}

TEST_F(ForgedDatabase, WhatAQueryRefusesOrAnswersOtherwiseIsNeverCalledSound) {
  const auto whole = seen(*folder / "a.talus");
  ASSERT_TRUE(whole);
  const Forgery sound = forgery_of("a.talus");
  std::vector<PageKey> keys;
  for (const auto& [key, any] : sound.stored) {
    if (key.table >= 0 && key.table < kRecordTable) keys.push_back(key);
  }
  int refused = 0, otherwise = 0, missed = 0;
  for (std::uint64_t seed = 1; seed <= 105; ++seed) {
    Random random(seed);
    Forgery forged = sound;
    const PageKey key = keys[static_cast<std::size_t>(random.between(0, static_cast<int>(keys.size()) - 1))];
    Page page = forged.page(page_at(key.table, key.position));
    if (page.grid.size() == 0) continue;
    const auto i = static_cast<std::size_t>(random.between(0, static_cast<int>(page.grid.size()) - 1));
    const GridPoint p =
        page.grid.at(static_cast<std::int32_t>(i) % page.grid.cols, static_cast<std::int32_t>(i) / page.grid.cols);
    const int what = random.between(0, page.children.empty() ? 3 : 7);
    if (what == 0) page.heights[i] += random.between(1, 30);
    if (what == 1 && page.is_own(p)) page.errors[i] = static_cast<ErrorCode>(random.between(0, 3000));
    if (what == 2 && !page.valid.empty()) page.valid[i] ^= 1;
    if (what == 3 && !page.covers.empty() && page.is_own(p))
      page.covers[i] = static_cast<std::uint8_t>(random.between(0, 15));
    if (what >= 4) {
      ChildEntry& child = page.children[static_cast<std::size_t>(random.between(0, 63))];
      if (what == 4) child.largest = static_cast<ErrorCode>(random.between(0, 4000));
      if (what == 5) child.generation ^= 1;
      if (what == 6) child = {};
      if (what == 7) child.present = !child.present;
    }
    forged.put(page);
    if (random.chance(0.5)) forged.hide();
    forged.write(*folder / "forged.talus");
    const auto now = seen(*folder / "forged.talus");
    const bool is_same = now && now->first.points == whole->first.points &&
                         now->first.heights == whole->first.heights && now->first.triangles == whole->first.triangles &&
                         now->second.values == whole->second.values && now->second.valid == whole->second.valid;
    refused += now ? 0 : 1;
    otherwise += now && !is_same ? 1 : 0;
    const VerifyReport report = verify(Database::open(*folder / "forged.talus").snapshot());
    EXPECT_TRUE(is_same || report.is_damaged()) << "seed " << seed << ", change " << what << " of " << key.table;
    missed += report.is_damaged() || forged.stored.at(key).content == sound.stored.at(key).content ? 0 : 1;
  }
  std::printf("%d refused by a query, %d answered otherwise, %d changes not found\n", refused, otherwise, missed);
  EXPECT_GT(refused + otherwise, 20);
  EXPECT_EQ(missed, 0);
}

}  // namespace
}  // namespace talus::support
