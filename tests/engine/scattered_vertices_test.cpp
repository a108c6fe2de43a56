// A few vertices anywhere on the grid, against std::set.

#include "engine/quadtree/scattered_vertices.hpp"

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/closed_sets.hpp"

namespace talus::support {
namespace {

TEST(ScatteredVertices, AreVisitedOnceFinestLevelFirst) {
  Random random(5);
  for (int time = 0; time < 30; ++time) {
    ScatteredVertices vertices;
    std::set<std::pair<std::int32_t, std::int32_t>> expected;
    for (int i = 0; i < 300; ++i) {
      const GridPoint p = random_point(random, {{-50, -50}, {50, 50}});
      vertices.insert(p);
      expected.insert({p.col, p.row});
    }
    std::set<std::pair<std::int32_t, std::int32_t>> visited;
    int last = -1;
    vertices.for_each([&](GridPoint p) {
      EXPECT_TRUE(visited.insert({p.col, p.row}).second) << "twice";
      const int level = 2 * height_in_tree(p) + (is_centre(p) ? 1 : 0);
      EXPECT_GE(level, last);
      last = level;
    });
    EXPECT_EQ(visited, expected);
  }
}

TEST(ScatteredVertices, OfOneLevelComeRowByRow) {
  Random random(6);
  ScatteredVertices vertices;
  for (int i = 0; i < 2000; ++i) vertices.insert(random_point(random, {{-60, -60}, {60, 60}}));
  for (int shift = 0; shift < 7; ++shift) {
    for (const bool centres : {false, true}) {
      std::vector<std::pair<std::int32_t, std::int32_t>> visited;
      vertices.for_each_of_level(shift, centres, [&](GridPoint p) {
        EXPECT_EQ(height_in_tree(p), shift);
        EXPECT_EQ(is_centre(p), centres);
        visited.emplace_back(p.row, p.col);
      });
      EXPECT_TRUE(std::is_sorted(visited.begin(), visited.end())) << "negative ones first";
    }
  }
}

TEST(ScatteredVertices, ParentsInsertedOnTheWayAreVisitedToo) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    ScatteredVertices vertices;
    ClosedSet expected(64);
    for (int i = 0; i < 20; ++i) {
      const GridPoint p = random_point(random, {{-31, -31}, {31, 31}});
      if (spacing(p) >= 64) continue;
      vertices.insert(p);
      expected.insert(p);
    }
    std::set<Point> visited;
    vertices.for_each([&](GridPoint p) {
      if (spacing(p) >= 64) return;
      EXPECT_TRUE(visited.insert(key(p)).second) << "twice";
      for (const GridPoint parent : diamond(p).apexes) vertices.insert(parent);
    });
    EXPECT_EQ(visited, expected.members());
  }
}

TEST(ScatteredVertices, TheFarthestCornersOfTheGridComeBack) {
  ScatteredVertices vertices;
  const std::vector<GridPoint> corners{{-kMaxExtent + 1, -kMaxExtent + 1},
                                       {kMaxExtent - 1, -kMaxExtent + 1},
                                       {-kMaxExtent + 1, kMaxExtent - 1},
                                       {kMaxExtent - 1, kMaxExtent - 1}};
  for (const GridPoint p : corners) vertices.insert(p);
  vertices.insert({0, 0});  // stands above every level
  std::vector<GridPoint> visited;
  vertices.for_each([&](GridPoint p) { visited.push_back(p); });
  ASSERT_EQ(visited.size(), 5u);
  EXPECT_EQ(std::vector<GridPoint>(visited.begin(), visited.begin() + 4), corners);
  EXPECT_EQ(visited.back(), (GridPoint{0, 0}));
}

}  // namespace
}  // namespace talus::support
