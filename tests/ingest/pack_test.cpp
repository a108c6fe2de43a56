// Pages from heights and errors, and what a page says of those below it.

#include "ingest/pack.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "engine/saturation.hpp"
#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

struct Packed {
  Field field;
  Manifest manifest;
  LevelGrid<ErrorCode> errors;
  std::vector<std::uint8_t> valid;  // empty: all data
  std::vector<Page> pages;

  explicit Packed(const Terrain& terrain, HeightStep step = {})
      : field(terrain, {0, 0}, step), errors(vertex_errors(field.input)) {
    manifest.description.extent = field.extent;
    manifest.description.step = step;
    manifest.bands = band_count(field.extent);
    manifest.exact = field.input.field.exact;
    saturate(field.input, errors);
    if (terrain.has_voids()) valid = field.valid;
    pack({manifest, field.input, errors, valid}, [&](const Page& page) { pages.push_back(page); });
  }

  [[nodiscard]] const Page* find(PageId id) const {
    const auto found = std::find_if(pages.begin(), pages.end(), [&](const Page& p) { return p.id == id; });
    return found == pages.end() ? nullptr : &*found;
  }
  [[nodiscard]] bool is_data(GridPoint p) const { return field.valid[field.index(p)] != 0; }
};

Terrain whole(Terrain terrain) {
  for (double& v : terrain.values) v = std::nearbyint(v);
  return terrain;
}

TEST(Pack, HandsOutEveryPageOnceBandsFinestFirstInCurveOrder) {
  const Packed packed(whole(fractal(700, 300, 1)));
  std::vector<PageId> expected;
  for (int band = 0; band < packed.manifest.bands; ++band) {
    for (const PageId id : pages_of_band(band, packed.field.extent)) expected.push_back(id);
  }
  std::vector<PageId> found;
  for (const Page& page : packed.pages) found.push_back(page.id);
  EXPECT_EQ(found, expected);
}

TEST(Pack, PagesCarryTheHeightsOfTheirSamplesAndTheErrorsOfTheirOwnVertices) {
  const Packed packed(whole(fractal(300, 200, 2)));
  for (const Page& page : packed.pages) {
    for (std::int32_t row = 0; row < page.grid.rows; ++row) {
      for (std::int32_t col = 0; col < page.grid.cols; ++col) {
        const GridPoint p = page.grid.at(col, row);
        const std::size_t i = page.index(col, row);
        ASSERT_EQ(page.heights[i], packed.field.input.field[p]) << name_of(p);
        if (!page.is_own(p)) {
          ASSERT_EQ(page.errors[i], 0) << name_of(p);
        } else if (spacing(p) >= packed.errors.root()) {
          ASSERT_EQ(page.errors[i], kAlwaysSelected);
        } else {
          ASSERT_EQ(page.errors[i], packed.errors[p]) << name_of(p);
        }
      }
    }
  }
}

/// What the entry for a page must say: by brute force over all vertices at or below it.
void expect_entry_holds(const Packed& packed, PageId id, const ChildEntry& entry) {
  const GridRect square = page_square(id);
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  ErrorCode largest = 0;
  bool data = false;
  for_each_point(packed.field.extent, [&](GridPoint p) {
    if (!square.contains(p) || band_of(p, packed.manifest.bands) > id.band) return;
    largest = std::max(largest, packed.errors[p]);
  });
  for_each_point(packed.field.extent, [&](GridPoint p) {
    if (!square.contains(p) || !packed.is_data(p)) return;
    const double height = packed.manifest.description.step.value(packed.field.input.field[p]);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
    data = true;
  });
  EXPECT_LE(static_cast<double>(entry.lowest), lowest);
  EXPECT_GE(static_cast<double>(entry.highest), highest);
  if (data) {
    EXPECT_GT(static_cast<double>(std::nextafter(entry.lowest, std::numeric_limits<float>::infinity())), lowest)
        << "too low";
    EXPECT_LT(static_cast<double>(std::nextafter(entry.highest, -std::numeric_limits<float>::infinity())), highest)
        << "too high";
    EXPECT_TRUE(entry.present);
  }
  if (entry.present) {
    EXPECT_EQ(entry.largest, largest) << id.x << " / " << id.y << " of band " << id.band;
  }
}

void expect_tables_tell_the_truth(const Packed& packed) {
  std::size_t looked_at = 0;
  for (const Page& page : packed.pages) {
    if (page.id.band == 0) {
      EXPECT_TRUE(page.children.empty());
      continue;
    }
    ASSERT_EQ(page.children.size(), static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross);
    for (std::size_t i = 0; i < page.children.size(); ++i) {
      const PageId below = child_page(page.id, i);
      EXPECT_EQ(page.children[i].present, packed.find(below) != nullptr) << below.x << " / " << below.y;
      if (!page.children[i].present) continue;
      expect_entry_holds(packed, below, page.children[i]);
      ++looked_at;
    }
  }
  EXPECT_GT(looked_at, 0u);
}

TEST(Pack, TablesSayWhatThePagesBelowHold) { expect_tables_tell_the_truth(Packed(whole(fractal(500, 300, 4)))); }

TEST(Pack, TablesAreRoundedOutwardForHeightsThatAreNoFloats) {
  Terrain terrain = fractal(300, 140, 5);
  for (double& v : terrain.values) v = v / 3 + 0.1;
  expect_tables_tell_the_truth(Packed(terrain));
}

TEST(Pack, PagesOfVoidsOnlyAreNotStoredAndTablesSaySo) {
  if (kPageSide != 128 || kBandLevels != 3) GTEST_SKIP() << "its numbers are those of 3 levels and 128² samples";
  // The second page of the row is void, and so is a wide rim around it.
  const Packed packed(hole(whole(fractal(520, 128, 6)), 100, 0, 300, 127));
  EXPECT_NE(packed.find({0, 0, 0}), nullptr);
  EXPECT_EQ(packed.find({0, 1, 0}), nullptr);
  EXPECT_NE(packed.find({0, 2, 0}), nullptr);
  expect_tables_tell_the_truth(packed);
}

TEST(Pack, VoidsAreMarkedAndPagesOfDataOnlyCarryNoMask) {
  if (kPageSide != 128 || kBandLevels != 3) GTEST_SKIP() << "its numbers are those of 3 levels and 128² samples";
  const Packed packed(hole(whole(fractal(300, 120, 7)), 10, 10, 20, 20));
  const Page &with = *packed.find({0, 0, 0}), &without = *packed.find({0, 2, 0});
  EXPECT_FALSE(with.valid.empty());
  EXPECT_FALSE(with.covers.empty());
  EXPECT_EQ(with.valid[with.index(15, 15)], 0);
  EXPECT_EQ(with.valid[with.index(9, 15)], 1);
  EXPECT_EQ(with.covers[with.index(15, 15)], 0) << "no triangle around it holds data";
  EXPECT_TRUE(without.valid.empty());
  EXPECT_TRUE(without.covers.empty());
}

}  // namespace
}  // namespace talus::support
