// One value for every vertex of the finest levels and of the rim around the extent.

#include "engine/error/level_grid.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "tests/engine/closed_sets.hpp"

namespace talus::support {
namespace {

GridRect random_extent(Random& random) {
  const GridPoint first{random.between(-100, 60), random.between(-100, 60)};
  return {first, {first.col + random.between(0, 50), first.row + random.between(0, 50)}};
}

TEST(LevelGrid, HoldsTheAncestorsOfEveryVertexOfTheExtent) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridRect extent = random_extent(random);
    const int levels = random.between(1, 7);
    const LevelGrid<int> grid(extent, levels, 3);
    ASSERT_EQ(grid.levels(), levels);
    ClosedSet all(1 << levels);
    for_each_point(extent, [&](GridPoint p) { all.insert(p); });
    for (const Point& p : all.members()) {
      ASSERT_TRUE(grid.holds(point(p))) << name_of(point(p));
      EXPECT_EQ(grid[point(p)], 3);
    }
    EXPECT_FALSE(grid.holds({0, 0})) << "of no level";
    EXPECT_FALSE(grid.holds({(extent.last.col + 1000) | 1, extent.first.row}));
  }
}

TEST(LevelGrid, EachVertexHasAValueOfItsOwnAndIsVisitedOnce) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    LevelGrid<int> grid(random_extent(random), 4, 0);
    std::map<Point, int> expected;
    int next = 1;
    for (int shift = 0; shift < 4; ++shift) {
      for (const bool centres : {false, true}) {
        grid.for_each(shift, centres, [&](GridPoint p) {
          EXPECT_EQ(spacing(p), 1 << shift);
          EXPECT_EQ(is_centre(p), centres);
          EXPECT_TRUE(grid.holds(p));
          EXPECT_TRUE(expected.emplace(key(p), next).second) << "twice";
          grid[p] = next++;
        });
      }
    }
    for (const auto& [p, value] : expected) {
      EXPECT_EQ(grid[point(p)], value);
      const std::int32_t s = spacing(point(p));
      const auto units = grid.units(height_in_tree(point(p)));
      ASSERT_TRUE(units.holds(p.first / s, p.second / s));
      EXPECT_EQ(units.at(p.first / s, p.second / s), value) << "by the level's own units";
      EXPECT_FALSE(units.holds(units.first_col - 1, units.first_row) ||
                   units.holds(units.first_col, units.last_row + 1));
    }
    // All that is held is visited.
    for_each_point({{-200, -200}, {200, 200}}, [&](GridPoint p) {
      if (grid.holds(p)) {
        EXPECT_TRUE(expected.contains(key(p))) << name_of(p);
      }
    });
  }
}

TEST(LevelGrid, SetAgainIsAsMadeAnewAndAnEmptyExtentHoldsNothing) {
  LevelGrid<int> grid({{0, 0}, {50, 50}}, 6, 1);
  grid[{3, 3}] = 9;
  grid.reset({{-7, -7}, {5, 5}}, 3, 4);
  EXPECT_EQ(grid.levels(), 3);
  grid.for_each(0, true, [&](GridPoint p) { EXPECT_EQ(grid[p], 4); });
  EXPECT_FALSE(grid.holds({41, 41}));
  const LevelGrid<int> none({{0, 0}, {-1, -1}}, 3, 0);
  for_each_point({{-20, -20}, {20, 20}}, [&](GridPoint p) { EXPECT_FALSE(none.holds(p)); });
}

}  // namespace
}  // namespace talus::support
