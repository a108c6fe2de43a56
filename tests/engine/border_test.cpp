// The border constraint: closed, tight, and agreed on by both sides of a shared line.

#include "engine/quadtree/border.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/engine/closed_sets.hpp"

namespace talus::support {
namespace {

GridRect random_rect(Random& random, int most) {
  const GridPoint first{random.between(-150, 150), random.between(-150, 150)};
  return {first, {first.col + random.between(1, most), first.row + random.between(1, most)}};
}

std::set<Point> forced(GridRect region, std::int32_t root) {
  const std::vector<GridPoint> points = border_vertices(region, root);
  std::set<Point> set;
  for (const GridPoint p : points) EXPECT_TRUE(set.insert(key(p)).second) << name_of(p) << " twice";
  return set;
}

TEST(Border, LiesInsideTheRegionAndHasItsCorners) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_rect(random, 90);
    const auto set = forced(region, root_side(region));
    for (const auto& p : set) EXPECT_TRUE(region.contains(point(p)));
    EXPECT_TRUE(set.contains(key(region.first)));
    EXPECT_TRUE(set.contains(key(region.last)));
    EXPECT_TRUE(set.contains({region.first.col, region.last.row}));
    EXPECT_TRUE(set.contains({region.last.col, region.first.row}));
  }
}

TEST(Border, IsClosedUnderParentsInsideTheRegion) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_rect(random, 90);
    const std::int32_t root = root_side(region);
    const auto set = forced(region, root);
    for (const auto& p : set) {
      if (spacing(point(p)) >= root) continue;
      for (const GridPoint parent : diamond(point(p)).apexes) {
        if (region.contains(parent)) {
          EXPECT_TRUE(set.contains(key(parent))) << name_of(parent) << " of " << name_of(point(p));
        }
      }
    }
  }
}

TEST(Border, DoesNotDependOnTheRoot) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const GridRect region = random_rect(random, 60);
    EXPECT_EQ(forced(region, root_side(region)), forced(region, 8 * root_side(region))) << "seed " << seed;
  }
}

/// The edges of a mesh that lie on a line of the grid, as from–to positions along it.
std::set<std::pair<int, int>> edges_on(const std::vector<Triangle>& triangles, bool column, std::int32_t line) {
  std::set<std::pair<int, int>> edges;
  for (const Triangle& t : triangles) {
    const std::array<GridPoint, 3> corners{t.apex, t.left, t.right};
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint a = corners[i], b = corners[(i + 1) % 3];
      if ((column ? a.col : a.row) != line || (column ? b.col : b.row) != line) continue;
      edges.insert(std::minmax(column ? a.row : a.col, column ? b.row : b.col));
    }
  }
  return edges;
}

TEST(Border, NoTriangleLeavesTheRegionWhateverElseIsSelected) {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_rect(random, 70);
    const std::int32_t root = root_side(region);
    ClosedSet set(root);
    // The border forces what it needs beyond the region, too: close what it returns.
    for (const GridPoint p : border_vertices(region, root)) set.insert(p);
    for (int i = random.between(0, 30); i > 0; --i) set.insert(random_point(random, region));
    std::int64_t twice_inside = 0;
    for (const Triangle& t : bisect(set)) {
      const bool in = region.contains(t.apex) && region.contains(t.left) && region.contains(t.right);
      EXPECT_TRUE(in || !overlaps(t, region)) << name_of(t.apex) << name_of(t.left) << name_of(t.right);
      if (in) twice_inside += area(t);
    }
    EXPECT_EQ(twice_inside, 2 * (region.cols() - 1) * (region.rows() - 1));
  }
}

TEST(Border, NoEdgeAlongASideIsLongerThanSixteen) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    GridRect region = random_rect(random, 200);
    if (random.chance(0.5)) region = {{-64, -128}, {64 * random.between(0, 2), 64 * random.between(-1, 3)}};
    ClosedSet set(root_side(region));
    for (const GridPoint p : border_vertices(region, set.root())) set.insert(p);
    const auto triangles = bisect(set);
    for (const bool column : {false, true}) {
      for (const GridPoint corner : {region.first, region.last}) {
        int longest = 0, covered = 0;
        const auto& [from, to] = region;
        for (const auto& [a, b] : edges_on(triangles, column, column ? corner.col : corner.row)) {
          if (a < (column ? from.row : from.col) || b > (column ? to.row : to.col)) continue;
          longest = std::max(longest, b - a);
          covered += b - a;
        }
        EXPECT_LE(longest, kLongestBorderEdge);
        EXPECT_EQ(covered, column ? region.rows() - 1 : region.cols() - 1);
      }
    }
  }
}

TEST(Border, NeighboursSixteenDeepForceTheSameVerticesOnASharedSide) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const int line = random.between(-130, 130), from = random.between(-130, 130), to = from + random.between(1, 120);
    const int west = line - random.between(16, 40), east = line + random.between(16, 40);
    for (const bool column : {false, true}) {
      const GridRect one = column ? GridRect{{west, from}, {line, to}} : GridRect{{from, west}, {to, line}};
      const GridRect two = column ? GridRect{{line, from}, {east, to}} : GridRect{{from, line}, {to, east}};
      const auto on_line = [&](GridRect region) {
        std::set<int> found;
        for (const auto& p : forced(region, 1024)) {
          const GridPoint q = point(p);
          if ((column ? q.col : q.row) == line) found.insert(column ? q.row : q.col);
        }
        return found;
      };
      EXPECT_EQ(on_line(one), on_line(two))
          << (column ? "column " : "row ") << line << " from " << from << " to " << to;
    }
  }
}

TEST(Border, OnMultiplesOfSixteenItIsCheap) {
  // One vertex for each sixteen cells of border, and their few ancestors.
  const GridRect region{{0, 0}, {256, 256}};
  EXPECT_LT(border_vertices(region, 512).size(), 256u);
}

TEST(Border, ALineOrASinglePointIsStillClosed) {
  for (const GridRect region : {GridRect{{5, 7}, {5, 7}}, GridRect{{3, 9}, {40, 9}}, GridRect{{-8, -20}, {-8, 13}}}) {
    EXPECT_TRUE(forced(region, root_side(region)).contains(key(region.first)));
  }
}

}  // namespace
}  // namespace talus::support
