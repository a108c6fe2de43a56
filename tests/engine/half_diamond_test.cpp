// Halves of diamonds, row by row, and the plane over them.

#include "engine/quadtree/half_diamond.hpp"

#include <set>

#include <gtest/gtest.h>

#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

/// Inside or on the edge, by the signs of three cross products.
bool holds(const HalfDiamond& t, GridPoint p) {
  const auto cross = [](GridPoint a, GridPoint b, GridPoint c) {
    return (b.col - a.col) * (c.row - a.row) - (b.row - a.row) * (c.col - a.col);
  };
  const int one = cross(t.apex, t.a, p), two = cross(t.a, t.b, p), three = cross(t.b, t.apex, p);
  return (one >= 0 && two >= 0 && three >= 0) || (one <= 0 && two <= 0 && three <= 0);
}

template <class Visit>
void for_each_half(Visit&& visit) {
  for_each_point({{-40, -40}, {40, 40}}, [&](GridPoint p) {
    if (p == GridPoint{0, 0}) return;
    for (const int side : {0, 1}) visit(half_diamond(p, side));
  });
}

TEST(HalfDiamond, ColumnsOfItsRowsAreTheClosedTriangle) {
  for_each_half([](const HalfDiamond& t) {
    if (t.s > 16) return;
    std::int64_t listed = 0, held = 0;
    for (std::int32_t row = t.top(); row <= t.bottom(); ++row) {
      const auto [lo, hi] = t.columns(row);
      EXPECT_LE(lo, hi);
      for (std::int32_t col = lo; col <= hi; ++col, ++listed) {
        EXPECT_TRUE(holds(t, {col, row})) << name_of(t.vertex) << " lists " << name_of({col, row});
      }
    }
    const GridRect around{{t.vertex.col - 2 * t.s, t.vertex.row - 2 * t.s},
                          {t.vertex.col + 2 * t.s, t.vertex.row + 2 * t.s}};
    for_each_point(around, [&](GridPoint p) { held += holds(t, p) ? 1 : 0; });
    EXPECT_EQ(listed, held) << name_of(t.vertex);
  });
}

TEST(HalfDiamond, IsInsideARectangleIffItsCornersAre) {
  const HalfDiamond t = half_diamond({4, 4}, 0);
  EXPECT_TRUE(inside(t, {{0, 0}, {8, 8}}));
  EXPECT_FALSE(inside(t, {{1, 0}, {8, 8}}));
  EXPECT_FALSE(inside(t, {{0, 0}, {8, 7}}));
}

TEST(HalfDiamond, ThePlanePassesThroughItsThreeCorners) {
  Random random(1);
  for_each_half([&](const HalfDiamond& t) {
    const double apex = random.between(-99, 99), a = random.between(-99, 99), b = random.between(-99, 99);
    const auto plane = plane_of(t, [&](GridPoint p) { return p == t.apex ? apex : p == t.a ? a : b; });
    const auto at = [&](GridPoint p) { return plane.on_row(p.row) + plane.right * (p.col - plane.col); };
    EXPECT_EQ(at(t.apex), apex) << name_of(t.vertex);
    EXPECT_EQ(at(t.a), a) << name_of(t.vertex);
    EXPECT_EQ(at(t.b), b) << name_of(t.vertex);
    EXPECT_EQ(at(t.vertex), (a + b) / 2) << name_of(t.vertex);
  });
}

}  // namespace
}  // namespace talus::support
