// The plain loop that defines a vertex's error, and the arithmetic it rests on.

#include "engine/error/vertex_error.hpp"

#include <cmath>
#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

#include "engine/error/saturation.hpp"
#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

TEST(VertexError, LooksAtEverySampleOfTheDiamondNotAtItsMidpoint) {
  // Heights 0, 1.5, 1, 0.5, 0 along every row: the middle is off by 1, the first quarter by 1.5.
  const double profile[] = {0, 1.5, 1, 0.5, 0};
  const Field field(surface(8, 8, [&](int col, int) { return col < 5 ? profile[col] : 0.0; }));
  const LevelGrid<ErrorCode> errors = reference_errors(field.input, field.levels());
  EXPECT_EQ(error_of(errors[{2, 4}]), 1.5);
}

TEST(VertexError, ASpikeIsTheErrorOfEveryDiamondAroundItButItsOwnHalf) {
  const Field field(spike(64, 64, 21, 34, 50));
  LevelGrid<ErrorCode> errors = reference_errors(field.input, field.levels());
  EXPECT_EQ(error_of(errors[{21, 34}]), 50);
  saturate(field.input, errors);
  EXPECT_EQ(error_of(errors[{32, 32}]), 50);
  EXPECT_EQ(error_of(errors[{3, 3}]), 0);
}

TEST(VertexError, AHalfThatLeavesTheExtentCarriesNoError) {
  const Field field(spike(10, 10, 8, 8, 50));  // triangles of (8, 8) itself reach far beyond the ninth column
  EXPECT_EQ(reference_half_error(field.input, {8, 8}, 0), 0);
  EXPECT_EQ(reference_half_error(field.input, {8, 8}, 1), 0);
}

TEST(VertexError, AMixedTriangleIsAtLeastItsWeightedGroundSide) {
  Terrain terrain = plane(9, 9, 100, 0, 0);
  terrain.make_void(1, 2);
  Field field(terrain);
  field.input.void_weight = 3;
  const int side = half_diamond({4, 4}, 0).apex == GridPoint{0, 8} ? 0 : 1;  // the half that holds the void
  EXPECT_EQ(reference_half_error(field.input, {4, 4}, side), 3 * 3 * 4);
  EXPECT_EQ(reference_half_error(field.input, {4, 4}, 1 - side), 0);
}

TEST(VertexError, MetresFollowFromTheStepByDivisionSoThatThreeTenthsAreThreeTenths) {
  const CodeDistance tenths(HeightStep{1, 10, 0, true}, 1);
  EXPECT_EQ(tenths.metres(3), 0.3);
  const CodeDistance scaled(HeightStep{0.1, 1, 0, true}, 1);
  EXPECT_EQ(scaled.metres(3), 0.3);
  EXPECT_FALSE(tenths.is_binary());
  EXPECT_TRUE(CodeDistance(HeightStep{-0.25, 1, 7, true}, 1).is_binary());
  EXPECT_EQ(CodeDistance(HeightStep{-0.25, 1, 7, true}, 1).metres(3), 0.75);
}

// ---- finest errors ---------------------------------------------------------------------------------

TEST(FinestError, IsTheMidpointResidual) {
  const CodeDistance metres;
  EXPECT_EQ(finest_error(5, 1, 2, metres), 3.5);
  EXPECT_EQ(finest_error(-5, 1, 2, metres), 6.5);
  EXPECT_EQ(finest_error(1.5, 1, 2, metres), 0);
}

TEST(FinestError, CarriesTheMarginOnlyWhereItsArithmeticRounds) {
  const CodeDistance metres;
  EXPECT_EQ(finest_error(1.5, 1, 2, metres), 0);
  EXPECT_EQ(finest_error(2.5, 1, 2, metres), 1);
  // The sum rounds to twice the middle, but is not it.
  EXPECT_EQ(finest_error(0.5, 1, 0x1p-60, metres), kRoundingMargin);
  EXPECT_EQ(finest_error(0x1p-60, 1, 1, metres), 1 + kRoundingMargin);
}

TEST(FinestError, AgreesWithTheErrorOfEveryFinestSideMidpoint) {
  Random random(5);
  for (const bool decimals : {false, true}) {
    Terrain terrain = noise(70, 70, 9, -10, 10);
    for (double& v : terrain.values) v = decimals ? v : std::nearbyint(v);
    const Field field(terrain, {-3, 5});
    LevelGrid<ErrorCode> errors = reference_errors(field.input, field.levels());
    saturate(field.input, errors);
    for_each_point(field.extent, [&](GridPoint p) {
      if (spacing(p) != 1 || is_centre(p)) return;
      const Diamond d = diamond(p);
      // A midpoint of the raster's own side has one half; one whose ends are missing has none.
      if (!inside(half_diamond(p, 0), field.extent) && !inside(half_diamond(p, 1), field.extent)) return;
      const HeightField& h = field.input.field;
      EXPECT_EQ(errors[p], error_code(finest_error(h[p], h[d.ends[0]], h[d.ends[1]], h.distance))) << name_of(p);
    });
  }
}

TEST(HalvesExactly, SeesWhatDoublesRoundAway) {
  EXPECT_TRUE(halves_exactly(1, 2, 1.5));
  EXPECT_TRUE(halves_exactly(0.1, 0.1, 0.1));
  EXPECT_FALSE(halves_exactly(1, 0x1p-60, 0.5));
  EXPECT_FALSE(halves_exactly(1, 0x1p-53, 0.5));
  EXPECT_FALSE(halves_exactly(0.1, 0.3, std::nextafter(0.2, 1)));
}

}  // namespace
}  // namespace talus::support
