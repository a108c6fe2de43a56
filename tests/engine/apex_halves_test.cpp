// The four apex triangles of a vertex by their distances, against the coordinate essay of grid.hpp.

#include "engine/quadtree/apex_halves.hpp"

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

/// Grid points of all kinds and levels, on both sides of the origin.
template <class Visit>
void for_each_vertex_around(Visit&& visit) {
  for_each_point({{-70, -70}, {70, 70}}, [&](GridPoint p) {
    if (spacing(p) <= 32) visit(p);
  });
}

TEST(ApexHalves, AKindSaysHowTheHypotenuseLies) {
  for_each_vertex_around([](GridPoint p) {
    const VertexKind kind = kind_of(p, spacing(p));
    const GridPoint a = diamond(p).ends[0], b = diamond(p).ends[1];
    const int cols = b.col - a.col, rows = b.row - a.row;
    const VertexKind expected = rows == 0                  ? VertexKind::level_side
                                : cols == 0                ? VertexKind::upright_side
                                : (cols > 0) == (rows > 0) ? VertexKind::falling_centre
                                                           : VertexKind::rising_centre;
    EXPECT_EQ(kind, expected) << name_of(p);
    EXPECT_EQ(is_centre(kind), is_centre(p)) << name_of(p);
  });
}

TEST(ApexHalves, EachApexTriangleIsTheHalfOfTheVertexThatSplitsIt) {
  for_each_vertex_around([](GridPoint p) {
    const std::int32_t s = spacing(p);
    if (s == 1 && !is_centre(p)) return;  // those are split by none
    const std::int32_t unit = is_centre(p) ? s : s / 2;
    const std::array<ApexHalf, 4> halves = apex_halves(kind_of(p, s));
    const std::array<Triangle, 4> triangles = apex_triangles(p);
    for (std::size_t i = 0; i < 4; ++i) {
      const GridPoint split{p.col + halves[i].col * unit, p.row + halves[i].row * unit};
      EXPECT_EQ(split, midpoint(triangles[i].left, triangles[i].right)) << name_of(p) << " triangle " << i;
      EXPECT_EQ(diamond(split).apexes[halves[i].side], p) << name_of(p) << " triangle " << i;
    }
  });
}

TEST(ApexHalves, AFinestTriangleHasDataWhereItsThreeCornersDo) {
  Random random(1);
  for (int time = 0; time < 200; ++time) {
    std::array<std::uint8_t, 25> valid{};
    for (std::uint8_t& v : valid) v = random.chance(0.8) ? 1 : 0;
    const GridPoint first{random.between(-9, 9), random.between(-9, 9)};
    const auto at = [&](GridPoint p) {
      return static_cast<std::size_t>((p.row - first.row) * 5 + (p.col - first.col));
    };
    for_each_point({{first.col + 1, first.row + 1}, {first.col + 3, first.row + 3}}, [&](GridPoint p) {
      if (spacing(p) != 1 || is_centre(p)) return;
      unsigned expected = 0;
      const std::array<Triangle, 4> triangles = apex_triangles(p);
      for (std::size_t i = 0; i < 4; ++i) {
        const auto [apex, left, right] = triangles[i];
        if (valid[at(apex)] != 0 && valid[at(left)] != 0 && valid[at(right)] != 0) expected |= 1u << i;
      }
      EXPECT_EQ(finest_apex_triangles(&valid[at(p)], 5, kind_of(p, 1)), expected) << name_of(p);
    });
  }
}

}  // namespace
}  // namespace talus::support
