// The cut into pages: every sample has its place, and one only.

#include "engine/page/page_layout.hpp"

#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

GridRect random_extent(Random& random) {
  const GridPoint first{random.between(-500, 300), random.between(-500, 300)};
  return {first, {first.col + random.between(0, 500), first.row + random.between(0, 500)}};
}

TEST(PageLayout, CurvePositionAndPageAtAreInverse) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    const int reach = i < 10000 ? 100 : kMost;
    const PageId id{random.between(0, 9), random.between(-reach, reach), random.between(-reach, reach)};
    EXPECT_EQ(page_at(id.band, curve_position(id)), id) << id.x << " / " << id.y;
    const std::uint64_t position = random.next();
    EXPECT_EQ(curve_position(page_at(0, position)), position);
  }
  EXPECT_EQ(page_at(3, curve_position({3, -1, 0})), (PageId{3, -1, 0}));
}

TEST(PageLayout, TheCurveKeepsPagesBelowOnePageTogether) {
  const PageId parent{2, -3, 5};
  std::uint64_t lowest = ~std::uint64_t{0}, highest = 0;
  std::set<std::uint64_t> positions;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross; ++i) {
    const PageId child = child_page(parent, i);
    EXPECT_EQ(parent_page(child), parent);
    positions.insert(curve_position(child));
    lowest = std::min(lowest, curve_position(child));
    highest = std::max(highest, curve_position(child));
  }
  EXPECT_EQ(positions.size(), static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross);
  EXPECT_EQ(highest - lowest + 1, positions.size());
}

TEST(PageLayout, PagesBelowTileTheSquare) {
  const PageId parent{1, -2, 3};
  const GridRect square = page_square(parent);
  EXPECT_EQ(page_square(child_page(parent, 0)).first, square.first);
  const auto last = static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross - 1;
  EXPECT_EQ(page_square(child_page(parent, last)).last, square.last);
  // Row by row: the second stands east of the first.
  EXPECT_EQ(page_square(child_page(parent, 1)).first.col, page_square(child_page(parent, 0)).last.col + 1);
  EXPECT_EQ(page_square(child_page(parent, 1)).first.row, square.first.row);
}

TEST(PageLayout, EverySampleOfABandIsInExactlyOneOfItsPages) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect extent = random_extent(random);
    for (int band = 0; band < band_count(extent); ++band) {
      std::size_t held = 0;
      for (const PageId id : pages_of_band(band, extent)) {
        const PageGrid grid = page_grid(id, extent);
        EXPECT_TRUE(overlap(page_square(id), extent));
        EXPECT_LE(grid.cols, kPageSide);
        EXPECT_LE(grid.rows, kPageSide);
        held += grid.size();
        if (grid.size() == 0) continue;  // it may have pages below it
        for (const auto& [col, row] : {std::pair{0, 0}, {grid.cols - 1, grid.rows - 1}}) {
          const GridPoint p = grid.at(col, row);
          EXPECT_EQ(page_of(p, band), id) << name_of(p);
          EXPECT_TRUE(extent.contains(p)) << name_of(p);
          EXPECT_TRUE(page_square(id).contains(p)) << name_of(p);
          EXPECT_EQ((p.col | p.row) & (band_spacing(band) - 1), 0);
        }
      }
      // Pages do not overlap, and together they have every multiple of the spacing.
      std::size_t wanted = 0;
      for_each_point(extent, [&](GridPoint p) { wanted += ((p.col | p.row) & (band_spacing(band) - 1)) == 0 ? 1 : 0; });
      EXPECT_EQ(held, wanted) << "band " << band;
    }
  }
}

TEST(PageLayout, PagesOfABandComeInCurveOrder) {
  const auto pages = pages_of_band(0, {{-300, -300}, {700, 400}});
  for (std::size_t i = 1; i < pages.size(); ++i) EXPECT_LT(curve_position(pages[i - 1]), curve_position(pages[i]));
}

TEST(PageLayout, AVertexBelongsToTheBandOfItsSpacing) {
  EXPECT_EQ(band_of({1, 0}, 3), 0);
  EXPECT_EQ(band_of({4, 12}, 3), 0);
  EXPECT_EQ(band_of({8, 16}, 3), 1);
  EXPECT_EQ(band_of({-32, 96}, 3), 1);
  EXPECT_EQ(band_of({64, 0}, 3), 2);
  EXPECT_EQ(band_of({4096, 0}, 3), 2) << "the coarsest band holds all above it";
  EXPECT_EQ(band_of({0, 0}, 3), 2);
}

TEST(PageLayout, TheCoarsestBandReachesTheRoot) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    const auto reach = static_cast<std::int32_t>(random.log_between(1, kMaxExtent - 1));
    const GridRect extent{{random.between(-reach, 0), random.between(-reach, 0)},
                          {random.between(0, reach), random.between(0, reach)}};
    const int bands = band_count(extent);
    const std::int64_t side = std::int64_t{kPageSide} << band_shift(bands - 1);
    EXPECT_GE(side, root_side(extent));
    EXPECT_TRUE(bands == kFewestBands || side >> kBandLevels < root_side(extent)) << "one band too many";
    EXPECT_LE(pages_of_band(bands - 1, extent).size(), 4u);
  }
  EXPECT_EQ(band_count({{0, 0}, {8191, 8191}}), 3);
  EXPECT_EQ(band_count({{0, 0}, {8192, 0}}), 4);
  EXPECT_EQ(band_count({{-1, 0}, {8191, 0}}), 3);
}

TEST(PageLayout, NegativeExtentsAreCutAtMultiplesToo) {
  const GridRect extent{{-130, -1}, {5, 9}};
  const PageGrid west = page_grid({0, -2, 0}, extent), middle = page_grid({0, -1, -1}, extent),
                 none = page_grid({0, 1, 0}, extent);
  EXPECT_EQ(west.first, (GridPoint{-130, 0}));
  EXPECT_EQ(west.cols, 2);
  EXPECT_EQ(middle.first, (GridPoint{-128, -1}));
  EXPECT_EQ(middle.cols, 128);
  EXPECT_EQ(middle.rows, 1);
  EXPECT_EQ(none.size(), 0u);
  const PageGrid coarse = page_grid({1, -1, 0}, extent);
  EXPECT_EQ(coarse.at(0, 0), (GridPoint{-128, 0}));
  EXPECT_EQ(coarse.at(1, 1), (GridPoint{-120, 8}));
  EXPECT_EQ(coarse.cols, 16);
  EXPECT_EQ(coarse.rows, 2);
}

TEST(PageLayout, RectanglesOverlapIffTheyShareASample) {
  const GridRect a{{0, 0}, {4, 4}};
  EXPECT_TRUE(overlap(a, {{4, 4}, {9, 9}}));
  EXPECT_FALSE(overlap(a, {{5, 0}, {9, 4}}));
  EXPECT_FALSE(overlap(a, {{0, -3}, {4, -1}}));
}

}  // namespace
}  // namespace talus::support
