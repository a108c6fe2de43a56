// What a grid point's coordinates say: its diamond, its parents, its children.

#include "engine/quadtree/grid.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "engine/quadtree/apex_halves.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

constexpr GridRect kAround{{-70, -70}, {70, 70}};

/// Twice the area, positive.
std::int64_t area(GridPoint a, GridPoint b, GridPoint c) {
  const std::int64_t cross = (std::int64_t{b.col} - a.col) * (std::int64_t{c.row} - a.row) -
                             (std::int64_t{b.row} - a.row) * (std::int64_t{c.col} - a.col);
  return cross < 0 ? -cross : cross;
}

std::int64_t squared(GridPoint a, GridPoint b) {
  const std::int64_t x = std::int64_t{a.col} - b.col, y = std::int64_t{a.row} - b.row;
  return x * x + y * y;
}

TEST(Grid, SpacingIsTheLowestBitOfEitherCoordinate) {
  EXPECT_EQ(spacing({1, 0}), 1);
  EXPECT_EQ(spacing({4, 6}), 2);
  EXPECT_EQ(spacing({-8, 24}), 8);
  EXPECT_EQ(spacing({0, -64}), 64);
  EXPECT_EQ(spacing({0, 0}), kRootSpacing);
  EXPECT_EQ(height_in_tree({-8, 24}), 3);
  EXPECT_EQ(height_in_tree({7, 0}), 0);
}

TEST(Grid, CentresAreOddBothWays) {
  EXPECT_TRUE(is_centre({1, 1}));
  EXPECT_TRUE(is_centre({-2, 6}));
  EXPECT_FALSE(is_centre({2, 4}));
  EXPECT_FALSE(is_centre({-3, 0}));
  EXPECT_FALSE(is_centre({0, 0}));
}

TEST(Grid, AVertexIsTheMiddleOfItsHypotenuseAndTheApexesStandAcross) {
  for_each_point(kAround, [](GridPoint p) {
    if (p == GridPoint{0, 0}) return;
    const Diamond d = diamond(p);
    EXPECT_EQ(midpoint(d.ends[0], d.ends[1]), p) << name_of(p);
    EXPECT_EQ(midpoint(d.apexes[0], d.apexes[1]), p) << name_of(p);
    EXPECT_NE(d.apexes[0], d.apexes[1]);
    for (const GridPoint apex : d.apexes) {  // a right angle, legs of one length
      EXPECT_EQ(squared(apex, d.ends[0]), squared(apex, d.ends[1])) << name_of(p);
      EXPECT_EQ(squared(apex, d.ends[0]) * 2, squared(d.ends[0], d.ends[1])) << name_of(p);
    }
  });
}

TEST(Grid, ParentsAndChildrenAreInverseRelations) {
  std::size_t edges = 0;
  for_each_point(kAround, [&](GridPoint p) {
    if (p == GridPoint{0, 0}) return;
    for (const GridPoint parent : diamond(p).apexes) {
      if (parent == GridPoint{0, 0}) continue;  // a root corner: all of the plane's sizes hang on it
      const Children back = children(parent);
      EXPECT_TRUE(std::find(back.at.begin(), back.at.begin() + back.count, p) != back.at.begin() + back.count)
          << name_of(p) << " is no child of its parent " << name_of(parent);
      ++edges;
    }
    const Children below = children(p);
    for (int i = 0; i < below.count; ++i) {
      const Diamond d = diamond(below.at[static_cast<std::size_t>(i)]);
      EXPECT_TRUE(d.apexes[0] == p || d.apexes[1] == p)
          << name_of(p) << " is no parent of its child " << name_of(below.at[static_cast<std::size_t>(i)]);
    }
    EXPECT_EQ(below.count, spacing(p) == 1 && !is_centre(p) ? 0 : 4);
  });
  EXPECT_GT(edges, 30000u);
}

TEST(Grid, ParentsAreOneBisectionAbove) {
  for_each_point(kAround, [](GridPoint p) {
    if (p == GridPoint{0, 0}) return;
    for (const GridPoint parent : diamond(p).apexes) {
      if (is_centre(p)) {
        EXPECT_GE(spacing(parent), 2 * spacing(p));
      } else {
        EXPECT_TRUE(is_centre(parent));
        EXPECT_EQ(spacing(parent), spacing(p));
      }
    }
    // One parent of a centre is the split vertex of a bisection earlier: not both stand higher.
    if (is_centre(p)) {
      const Diamond d = diamond(p);
      EXPECT_EQ(std::min(spacing(d.apexes[0]), spacing(d.apexes[1])), 2 * spacing(p)) << name_of(p);
    }
  });
}

TEST(Grid, HalvesHaveTheCornersTheirDiamondSays) {
  for_each_point(kAround, [](GridPoint p) {
    if (p == GridPoint{0, 0}) return;
    const Diamond d = diamond(p);
    for (const int side : {0, 1}) {
      const HalfDiamond t = half_diamond(p, side);
      EXPECT_EQ(t.vertex, p);
      EXPECT_EQ(t.apex, d.apexes[static_cast<std::size_t>(side)]);
      EXPECT_EQ(t.a, d.ends[0]);
      EXPECT_EQ(t.b, d.ends[1]);
      EXPECT_EQ(t.s, spacing(p));
      EXPECT_EQ(t.centre, is_centre(p));
      const std::int64_t s = spacing(p);
      EXPECT_EQ(area(t.apex, t.a, t.b), (t.centre ? 4 : 2) * s * s);
    }
  });
}

TEST(Grid, ApexTrianglesTileTheDiamond) {
  for_each_point(kAround, [](GridPoint p) {
    if (p == GridPoint{0, 0}) return;
    const Diamond d = diamond(p);
    const auto triangles = apex_triangles(p);
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(triangles[i].apex, p);
      EXPECT_EQ(triangles[i].left, d.apexes[i / 2]);
      EXPECT_EQ(triangles[i].right, d.ends[i % 2]);
      EXPECT_EQ(squared(p, triangles[i].left), squared(p, triangles[i].right));
      EXPECT_EQ(squared(triangles[i].left, triangles[i].right), 2 * squared(p, triangles[i].left));
      sum += area(p, triangles[i].left, triangles[i].right);
    }
    EXPECT_EQ(sum, area(d.apexes[0], d.ends[0], d.ends[1]) + area(d.apexes[1], d.ends[0], d.ends[1]));
  });
}

TEST(Grid, AnApexTriangleIsOneHalfOfTheDiamondThatSplitsIt) {
  for_each_point(kAround, [](GridPoint p) {
    if (p == GridPoint{0, 0} || (spacing(p) == 1 && !is_centre(p))) return;
    for (const Triangle& t : apex_triangles(p)) {
      const GridPoint split = midpoint(t.left, t.right);
      const Diamond d = diamond(split);
      EXPECT_TRUE(d.apexes[0] == p || d.apexes[1] == p) << name_of(p);
      EXPECT_EQ((std::set{std::pair{d.ends[0].col, d.ends[0].row}, std::pair{d.ends[1].col, d.ends[1].row}}),
                (std::set{std::pair{t.left.col, t.left.row}, std::pair{t.right.col, t.right.row}}));
    }
  });
}

TEST(Grid, ApexHalvesAreTheHalvesThatApexTrianglesAre) {
  for_each_point(kAround, [](GridPoint p) {
    if (p == GridPoint{0, 0} || (spacing(p) == 1 && !is_centre(p))) return;
    const std::int32_t s = spacing(p), step = is_centre(p) ? s : s / 2;
    const auto triangles = apex_triangles(p);
    const auto halves = apex_halves(kind_of(p, s));
    for (std::size_t i = 0; i < 4; ++i) {
      const GridPoint split = midpoint(triangles[i].left, triangles[i].right);
      EXPECT_EQ(split, (GridPoint{p.col + halves[i].col * step, p.row + halves[i].row * step})) << name_of(p);
      EXPECT_EQ(p, diamond(split).apexes[halves[i].side]) << name_of(p);
    }
  });
}

TEST(Grid, FinestApexTrianglesHaveDataWhereTheirCornersHave) {
  const std::int32_t origin = -4, side = 9;
  const auto index = [&](GridPoint p) { return static_cast<std::size_t>((p.row - origin) * side + p.col - origin); };
  for (unsigned pattern = 0; pattern < 512; ++pattern) {
    for_each_point({{origin + 1, origin + 1}, {origin + side - 2, origin + side - 2}}, [&](GridPoint p) {
      if (spacing(p) != 1 || is_centre(p)) return;
      std::vector<std::uint8_t> valid(static_cast<std::size_t>(side * side), 1);
      for (int i = 0; i < 9; ++i) valid[index({p.col + i % 3 - 1, p.row + i / 3 - 1})] = pattern >> i & 1;
      unsigned expected = 0;
      const auto triangles = apex_triangles(p);
      for (std::size_t i = 0; i < 4; ++i) {
        const bool data = valid[index(p)] && valid[index(triangles[i].left)] && valid[index(triangles[i].right)];
        expected |= (data ? 1u : 0u) << i;
      }
      EXPECT_EQ(finest_apex_triangles(&valid[index(p)], side, kind_of(p, 1)), expected) << name_of(p) << " " << pattern;
    });
  }
}

TEST(Grid, TheRootIsTheSmallestSquareLargerThanTheExtent) {
  EXPECT_EQ(root_side({{0, 0}, {0, 0}}), 1);
  EXPECT_EQ(root_side({{0, 0}, {1, 1}}), 2);
  EXPECT_EQ(root_side({{0, 0}, {2, 1}}), 4);
  EXPECT_EQ(root_side({{0, 0}, {10, 127}}), 128);
  EXPECT_EQ(root_side({{0, 0}, {10, 128}}), 256);
  EXPECT_EQ(root_side({{-127, 0}, {5, 5}}), 128);
  EXPECT_EQ(root_side({{-128, 0}, {5, 5}}), 256);
}

TEST(Grid, ARootThatDoublesChangesNoInnerTriangle) {
  // Bisected from the root down, a square of side 32 has the triangles one of side 64 has there.
  const auto triangles_below = [](std::int32_t root) {
    std::set<std::array<std::int32_t, 6>> found;
    const auto visit = [&](auto&& self, Triangle t) -> void {
      if (std::max({t.apex.col, t.left.col, t.right.col, t.apex.row, t.left.row, t.right.row}) <= 16) {
        auto [left, right] = std::pair{t.left, t.right};
        if (left.col > right.col || (left.col == right.col && left.row > right.row)) std::swap(left, right);
        found.insert({t.apex.col, t.apex.row, left.col, left.row, right.col, right.row});
      }
      if (squared(t.left, t.right) <= 2) return;
      const GridPoint m = midpoint(t.left, t.right);
      const Diamond d = diamond(m);
      EXPECT_TRUE(d.apexes[0] == t.apex || d.apexes[1] == t.apex) << name_of(m);
      self(self, {m, t.apex, t.left});
      self(self, {m, t.apex, t.right});
    };
    visit(visit, {{root, 0}, {0, 0}, {root, root}});
    visit(visit, {{0, root}, {0, 0}, {root, root}});
    return found;
  };
  const auto small = triangles_below(32), large = triangles_below(64);
  EXPECT_GT(small.size(), 500u);
  EXPECT_EQ(small, large);
}

}  // namespace
}  // namespace talus::support
