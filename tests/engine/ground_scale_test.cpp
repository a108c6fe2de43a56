// Ground sizes of cells, against lengths known from elsewhere.

#include "engine/geo/ground_scale.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/quadtree/half_diamond.hpp"

namespace talus::support {
namespace {

Metres longest_side(const GroundScale& ground, const HalfDiamond& t) { return ground.longest_side(t.a, t.b, t.apex); }

constexpr double kRadius = 6378137, kFlattening = 1 / 298.257223563;  // WGS 84

/// The half of a side midpoint whose hypotenuse runs along a row, two cells wide.
HalfDiamond level_half() { return half_diamond({1, 0}, 1); }
/// Along a column, two cells tall.
HalfDiamond upright_half() { return half_diamond({0, 1}, 1); }

TEST(Geodesy, PlanarCellsAreTheSameEverywhere) {
  const GroundScale ground = GroundScale::planar(Metres{30}, Metres{10});
  EXPECT_EQ(longest_side(ground, level_half()).value, 60);
  EXPECT_EQ(longest_side(ground, upright_half()).value, std::hypot(30, 10));
  // Square halves have legs along the axes: the hypotenuse is the longest.
  EXPECT_EQ(longest_side(ground, half_diamond({-3, -3}, 0)).value, std::hypot(60, 20));
}

TEST(Geodesy, ADegreeAtTheEquatorIsWhatTheEllipsoidSays) {
  const GridRect extent{{0, -2}, {10, 2}};
  const GroundScale ground = GroundScale::geographic({0, 0, 1, -1}, extent, Metres{kRadius}, kFlattening);
  EXPECT_NEAR(longest_side(ground, level_half()).value, 2 * 111319.490793, 1e-3);
  EXPECT_NEAR(longest_side(ground, upright_half()).value, std::max(2 * 110575.0, std::hypot(111319.490793, 110575.0)),
              10.0);
}

TEST(Geodesy, CellsNarrowTowardThePoles) {
  // Row 0 is at 60 degrees north: a degree of longitude is half of one at the equator, and a little more.
  const GroundScale ground = GroundScale::geographic({0, 60, 1, -0.1}, {{0, 0}, {10, 5}}, Metres{kRadius}, kFlattening);
  const HalfDiamond flat = half_diamond({1, 0}, diamond({1, 0}).apexes[0].row < 0 ? 0 : 1);
  EXPECT_NEAR(longest_side(ground, flat).value, 2 * 55800, 2 * 150);
}

TEST(Geodesy, TheWidestRowOfATriangleCounts) {
  // Across the equator neither end is widest.
  const GroundScale ground = GroundScale::geographic({0, 32, 1, -1}, {{0, 0}, {64, 64}}, Metres{kRadius}, kFlattening);
  const HalfDiamond tall = half_diamond({32, 32}, 0);
  EXPECT_GE(longest_side(ground, tall).value, std::hypot(64 * 111319.49, 64 * 110574.0));
}

TEST(Geodesy, IsNeverShorterThanAnySideOnAnyOfItsRows) {
  const GridMapping degrees{0, 80, 0.25, -0.25};
  const GridRect extent{{0, 0}, {128, 640}};
  const GroundScale ground = GroundScale::geographic(degrees, extent, Metres{kRadius}, kFlattening);
  for (std::int32_t row = 1; row < 640; row += 7) {
    for (const int side : {0, 1}) {
      const HalfDiamond t = half_diamond({64, row}, side);
      double widest = 0, across = 0;
      for (std::int32_t r = std::max(t.top(), 0); r <= std::min(t.bottom(), 640); ++r) {
        const auto [lo, hi] = t.columns(r);
        widest = std::max(widest, (hi - lo) * 0.25 * 111319.49 * std::cos(degrees.y(r) * M_PI / 180));
        across = std::max(across, 0.25 * 110574.0);
      }
      EXPECT_GE(longest_side(ground, t).value * 1.0001, widest) << row;
      EXPECT_GE(longest_side(ground, t).value * 1.0001, (t.bottom() - t.top()) * across) << row;
    }
  }
}

TEST(Geodesy, BeyondAPoleCountsAsThePole) {
  const GroundScale ground = GroundScale::geographic({0, 91, 1, -1}, {{0, 0}, {8, 8}}, Metres{kRadius}, kFlattening);
  const HalfDiamond top = half_diamond({1, 0}, diamond({1, 0}).apexes[0].row < 0 ? 0 : 1);
  EXPECT_TRUE(std::isfinite(longest_side(ground, top).value));
  EXPECT_GE(longest_side(ground, top).value, 111000) << "a degree of latitude is still one";
}

}  // namespace
}  // namespace talus::support
