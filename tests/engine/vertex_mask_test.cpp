// Sets of vertices and their ranks, against std::set.

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "talus/quadtree.hpp"
#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

TEST(VertexMask, AgreesWithASetOfPoints) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridPoint first{random.between(-1000, 1000), random.between(-1000, 1000)};
    // 63, 64 and 65 columns end before, on and after a word.
    const GridRect region{
        first, {first.col + random.between(0, 1) * 64 + random.between(0, 66), first.row + random.between(0, 40)}};
    const double density = random.unit();
    VertexMask mask(region);
    std::set<std::pair<int, int>> expected;  // row by row
    for_each_point(region, [&](GridPoint p) {
      if (!random.chance(density)) return;
      mask.insert(p);
      mask.insert(p);  // twice is once
      expected.insert({p.row, p.col});
    });
    mask.seal();
    EXPECT_EQ(mask.size(), expected.size());
    EXPECT_EQ(mask.region(), region);

    std::vector<GridPoint> points;
    for_each_point(region, [&](GridPoint p) { points.push_back(p); });
    std::vector<std::uint32_t> ranks(points.size());
    mask.ranks(points, ranks);
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const GridPoint p = points[i];
      const bool in = expected.contains({p.row, p.col});
      ASSERT_EQ(mask.contains(p), in) << name_of(p);
      ASSERT_EQ(mask.rank(p), before) << name_of(p);
      ASSERT_EQ(ranks[i], before) << name_of(p);
      before += in ? 1 : 0;
    }

    auto next = expected.begin();
    mask.for_each([&](GridPoint p) {
      ASSERT_NE(next, expected.end());
      EXPECT_EQ((std::pair{p.row, p.col}), *next++);
    });
    EXPECT_EQ(next, expected.end());
  }
}

TEST(VertexMask, SealsAgainAfterMoreWasInserted) {
  VertexMask mask({{0, 0}, {99, 9}});
  mask.insert({70, 3});
  mask.seal();
  EXPECT_EQ(mask.rank({71, 3}), 1u);
  mask.insert({2, 0});
  mask.seal();
  EXPECT_EQ(mask.size(), 2u);
  EXPECT_EQ(mask.rank({70, 3}), 1u);
}

TEST(VertexMask, AnEmptyOneHasNoMembers) {
  VertexMask none, mask({{5, 5}, {80, 6}});
  none.seal();
  mask.seal();
  EXPECT_EQ(none.size(), 0u);
  EXPECT_EQ(mask.size(), 0u);
  mask.for_each([](GridPoint) { FAIL(); });
}

}  // namespace
}  // namespace talus::support
