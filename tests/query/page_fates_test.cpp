// What QueryCost says of pages, against every stored page looked at by brute force.

#include "query/pages/page_fates.hpp"

#include <limits>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "engine/quadtree/border.hpp"
#include "engine/quadtree/construction.hpp"
#include "query/snapshot_view.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/forged_database.hpp"
#include "tests/support/random_raster.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {
namespace {

using Key = std::tuple<int, std::int32_t, std::int32_t>;
Key key(PageId id) { return {id.band, id.x, id.y}; }

/// Of every stored page: the largest error in it and in all pages that lie in its square.
std::map<Key, ErrorCode> largest_errors(const StoredPages& pages) {
  const Manifest& manifest = pages.manifest();
  std::map<Key, ErrorCode> largest;
  PageDecoder decoder;
  QueryCost unused;
  for (int band = 0; band < manifest.bands; ++band) {
    for (const PageId id : pages_of_band(band, manifest.description.extent)) {
      if (!pages.transaction().find({band, curve_position(id)})) continue;
      const Page& page = pages.get(id, decoder, unused, nullptr);
      ErrorCode most = 0;
      for (std::int32_t row = 0; row < page.grid.rows; ++row) {
        for (std::int32_t col = 0; col < page.grid.cols; ++col) {
          if (page.is_own(page.grid.at(col, row)))
            most = std::max(most, page.error(page.index(col, row), pages.distance()));
        }
      }
      for (int above = band; above < manifest.bands; ++above) {
        ErrorCode& there = largest[key(page_of(page_square(id).first, above))];
        there = std::max(there, most);
      }
    }
  }
  return largest;
}

/// Pages that hold vertices, and all above them.
std::set<Key> pages_with(const std::vector<GridPoint>& vertices, int bands) {
  std::set<Key> found;
  for (const GridPoint p : vertices) {
    for (PageId id = page_of(p, band_of(p, bands)); id.band < bands; id = parent_page(id)) found.insert(key(id));
  }
  return found;
}

struct Expected {
  const StoredPages& pages;
  std::map<Key, ErrorCode> largest = largest_errors(pages);

  /// forced  vertices that are needed whatever the tolerance
  [[nodiscard]] std::vector<BandCost> of(GridRect region, double tolerance,
                                         const std::vector<GridPoint>& forced) const {
    const Manifest& manifest = pages.manifest();
    const int bands = manifest.bands;
    const ErrorCode within = largest_code_within(tolerance);
    const std::set<Key> needed = pages_with(forced, bands);
    std::set<Key> looked_into;
    std::vector<BandCost> costs(static_cast<std::size_t>(bands));
    for (int band = bands - 1; band >= 0; --band) {
      BandCost& cost = costs[static_cast<std::size_t>(band)];
      cost.spacing = band_spacing(band);
      for (const PageId id : pages_of_band(band, manifest.description.extent)) {
        const bool is_top = band == bands - 1, is_met = is_top || looked_into.contains(key(parent_page(id)));
        if (!overlap(page_square(id), region)) {
          cost.outside += is_met;
          continue;
        }
        ++cost.in_region;
        if (!is_met) continue;
        const auto stored = largest.find(key(id));
        if (stored == largest.end()) {
          ++cost.only_voids;
        } else if (is_top || stored->second > within) {
          ++cost.wanted;
          looked_into.insert(key(id));
        } else if (needed.contains(key(id))) {
          ++cost.needed;
          looked_into.insert(key(id));
        } else {
          ++cost.below_tolerance;
        }
      }
    }
    return costs;
  }
};

void expect_same(const std::vector<BandCost>& found, const std::vector<BandCost>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t band = 0; band < found.size(); ++band) {
    SCOPED_TRACE("band " + std::to_string(band));
    EXPECT_EQ(found[band].spacing, expected[band].spacing);
    EXPECT_EQ(found[band].in_region, expected[band].in_region);
    EXPECT_EQ(found[band].wanted, expected[band].wanted);
    EXPECT_EQ(found[band].from_slice, expected[band].from_slice);
    EXPECT_EQ(found[band].needed, expected[band].needed);
    EXPECT_EQ(found[band].beyond, 0u);
    EXPECT_EQ(found[band].below_tolerance, expected[band].below_tolerance);
    EXPECT_EQ(found[band].too_fine, 0u);
    EXPECT_EQ(found[band].only_voids, expected[band].only_voids);
    EXPECT_EQ(found[band].outside, expected[band].outside);
  }
}

/// A slice stands for a tile's page, or only for pages below it: less is then known of those.
void expect_same_but_for_slices(const std::vector<BandCost>& found, std::vector<BandCost> expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (const std::size_t band : {0, 1}) {
    BandCost& of_pages = expected[band];
    EXPECT_LE(found[band].wanted + found[band].from_slice, of_pages.wanted);
    of_pages.wanted = found[band].wanted, of_pages.from_slice = found[band].from_slice;
  }
  if (found[1].from_slice > 0) expected[0] = found[0];
  expect_same(found, expected);
}

/// The parts are those of the whole.
void expect_sums(const QueryCost& cost) {
  QueryCost sum;
  sum.pages_read = 1;  // the header
  for (const BandCost& band : cost.bands) {
    sum.pages_read += band.pages_read;
    sum.pages_cached += band.pages_cached;
    sum.bytes_read += band.bytes_read;
    EXPECT_LE(band.wanted + band.needed + band.beyond, band.pages_read + band.pages_cached);
    EXPECT_LE(band.wanted + band.needed + band.from_slice + band.below_tolerance + band.too_fine + band.only_voids,
              band.in_region);
  }
  EXPECT_EQ(cost.pages_read, sum.pages_read);
  EXPECT_EQ(cost.pages_cached, sum.pages_cached);
  EXPECT_GT(cost.bytes_read, sum.bytes_read);
  EXPECT_GE(cost.seconds, cost.reading_seconds + cost.gathering_seconds);
}

/// Flat in one corner, void in the other and before it, and rough: every fate occurs.
class Fates : public ::testing::Test {
 protected:
  Fates() {
    for (int row = 0; row < 700; ++row) {
      for (int col = 0; col < 800; ++col) terrain.at(col, row) = 1000;
    }
    terrain = hole(terrain, 900, 600, 1300, 1300);
    terrain = hole(terrain, 900, 900, terrain.cols, terrain.rows);  // with all of a page of band 1
    write_raster(terrain, folder / "a.tif");
    ingest(folder / "a.tif", folder / "sliced.talus");
    Forgery pages_only(folder / "sliced.talus");
    static_cast<void>(pages_only.empty_slices());
    pages_only.write(folder / "a.talus");
    database.emplace(Database::open(folder / "a.talus"));
    now.emplace(database->snapshot());
    sliced.emplace(Database::open(folder / "sliced.talus").snapshot());
  }
  [[nodiscard]] const GridRect& extent() const { return now->description().extent; }
  const TempFolder folder;
  Terrain terrain = fit(fractal(1500, 1400, 5, 300), SampleType::int16);
  std::optional<Database> database;
  std::optional<Snapshot> now, sliced;  ///< slices of `now` hold nothing
};

TEST_F(Fates, OfARectangleAndOfAnIncrementAreThoseOfEveryStoredPage) {
  const StoredPages& pages = pages_of(*now);
  const Expected expected{pages};
  const std::int32_t root = root_side(extent());
  Random random(1);
  BandCost seen;
  for (int i = 0; i < 60; ++i) {
    const GridRect region = random_region(random, terrain);
    const double tolerance = i % 10 == 0 ? std::numeric_limits<double>::infinity() : random.log_between(0.3, 100);
    SCOPED_TRACE(std::to_string(i) + ": at " + std::to_string(tolerance));
    const QueryCost cost = now->ask({.region = region, .tolerance = Metres{tolerance}}).cost;
    expect_same(cost.bands, expected.of(region, tolerance, border_vertices(region, root)));
    expect_sums(cost);
    for (const BandCost& band : cost.bands) {
      EXPECT_EQ(band.wanted + band.needed, band.pages_read + band.pages_cached) << "no page is read twice";
      seen.needed += band.needed, seen.below_tolerance += band.below_tolerance;
      seen.only_voids += band.only_voids, seen.outside += band.outside;
      seen.in_region += band.unasked();
    }
    const QueryCost with_slices = sliced->ask({.region = region, .tolerance = Metres{tolerance}}).cost;
    expect_same_but_for_slices(with_slices.bands, cost.bands);
    expect_sums(with_slices);
    for (const BandCost& band : with_slices.bands) {
      EXPECT_EQ(band.wanted + band.needed, band.pages_read + band.pages_cached) << "no page is read twice";
      seen.from_slice += band.from_slice;
    }
    const double finer = tolerance < 1000 ? tolerance : 1;
    const QueryCost increment =
        increment_of(now->ask({.region = region, .tolerance = Metres{finer}, .from = Metres{2 * finer}})).cost;
    expect_sums(increment);
    expect_same(increment.bands, expected.of(region, finer, {}));
    if (HasFailure()) return;
  }
  for (const std::uint64_t count :
       {seen.needed, seen.from_slice, seen.below_tolerance, seen.only_voids, seen.outside, seen.in_region})
    EXPECT_GT(count, 0u) << "some fate was never tried";
}

TEST_F(Fates, AreTheSameWhoeverCounts) {
  for (const bool has_slices : {false, true}) {
    const Snapshot& one = has_slices ? *sliced : *now;
    const Snapshot several =
        Database::open(folder / (has_slices ? "sliced.talus" : "a.talus"), {.threads = 4}).snapshot();
    for (const double tolerance : {2.0, 60.0}) {
      const QueryCost cost = several.ask({.region = extent(), .tolerance = Metres{tolerance}}).cost;
      expect_same(cost.bands, one.ask({.region = extent(), .tolerance = Metres{tolerance}}).cost.bands);
      expect_sums(cost);
    }
  }
}

TEST_F(Fates, OfPointsAreThoseOfWhatTheyDependOn) {
  const StoredPages& pages = pages_of(*now);
  const Expected expected{pages};
  const std::int32_t root = root_side(extent());
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    Question q;
    q.region = random_region(random, terrain);
    q.tolerance = Metres{random.log_between(1, 100)};
    VertexMask needed(q.region);
    for (const GridPoint p : border_vertices(q.region, root)) needed.insert(p);
    for (int k = 0; k < 3; ++k) {
      const GridPoint p{random.between(q.region.first.col, q.region.last.col),
                        random.between(q.region.first.row, q.region.last.row)};
      q.points.push_back(p);
      if (terrain.is_valid(p.col, p.row)) needed.insert(p);
    }
    close_bottom_up(needed, root);
    std::vector<GridPoint> forced;
    needed.for_each([&](GridPoint p) { forced.push_back(p); });
    const QueryCost cost = now->ask(q).cost;
    expect_same(cost.bands, expected.of(q.region, q.tolerance.value, forced));
    expect_sums(cost);
    if (HasFailure()) return;
  }
}

TEST_F(Fates, OfOtherQuestionsAddUp) {
  Random random(3);
  for (int i = 0; i < 30; ++i) {
    Question q;
    q.region = random_region(random, terrain);
    q.tolerance = Metres{random.log_between(1, 100)};
    q.border = i % 3 == 0 ? Border::cover : Border::constrain;
    if (i % 3 != 2) q.max_level = random.between(0, 12);
    if (i % 3 == 2) q.field = patch_tolerance(q.region, 1, 1, {q.tolerance.value});
    const QueryCost cost = now->ask(q).cost;
    expect_sums(cost);
    for (std::size_t band = 0; band + 1 < cost.bands.size(); ++band) {
      // Level l has the spacing root / 2^(l + 1); a page's coarsest vertices stand four of its samples apart.
      const bool is_too_fine = q.max_level && 4 * cost.bands[band].spacing < root_side(extent()) >> (*q.max_level + 1);
      EXPECT_EQ(is_too_fine ? cost.bands[band].below_tolerance : cost.bands[band].too_fine, 0u)
          << q.max_level.value_or(31);
    }
  }
}

TEST_F(Fates, PagesFoundDecodedAreNotRead) {
  Question q;
  q.region = {{100, 100}, {1200, 1200}};
  q.tolerance = Metres{20};
  q.points = {{333, 777}};
  const QueryCost first = now->ask(q).cost, again = now->ask(q).cost;
  expect_sums(first);
  expect_sums(again);
  EXPECT_GT(first.pages_read, 1u);
  EXPECT_EQ(again.pages_read, 1u) << "the header";
  for (std::size_t band = 0; band < first.bands.size(); ++band) {
    EXPECT_EQ(first.bands[band].wanted, again.bands[band].wanted);
    EXPECT_EQ(again.bands[band].pages_read, 0u);
  }
}

}  // namespace
}  // namespace talus::support
