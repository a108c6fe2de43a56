// The fast kernels against the plain loop: after saturation they are one and the same.

#include "engine/vertex_error.hpp"

#include <cmath>
#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

#include "engine/saturation.hpp"
#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

void expect_fast_is_reference(const Field& field) {
  LevelGrid<ErrorCode> fast = vertex_errors(field.input), plain = reference_errors(field.input);
  saturate(field.input, fast);
  saturate(field.input, plain);
  std::size_t different = 0;
  for_each_vertex(plain, [&](GridPoint p) {
    if (fast[p] == plain[p] || ++different > 3) return;
    ADD_FAILURE() << "vertex " << name_of(p) << " of spacing " << spacing(p) << ": fast " << error_of(fast[p])
                  << " m, plain " << error_of(plain[p]) << " m";
  });
  EXPECT_EQ(different, 0u);
}

Terrain whole(Terrain terrain) {
  for (double& v : terrain.values) v = std::nearbyint(v);
  return terrain;
}

enum class Numbers { whole, wild_whole, halves, floats, doubles };

/// A terrain of any shape and any kind of number, with voids or without.
Terrain random_terrain(Random& random, Numbers numbers, int cols, int rows) {
  const std::uint64_t seed = random.next();
  Terrain terrain;
  switch (random.between(0, 5)) {
    case 0: terrain = fractal(cols, rows, seed); break;
    case 1: terrain = noise(cols, rows, seed, -50, 50); break;
    case 2: terrain = plateaus(cols, rows); break;
    case 3: terrain = cliff(cols, rows, 777); break;
    case 4: terrain = spike(cols, rows, random.between(0, cols - 1), random.between(0, rows - 1)); break;
    default: terrain = plane(cols, rows, 10, 1.0 / 7, 3); break;
  }
  for (double& v : terrain.values) {
    switch (numbers) {
      case Numbers::whole: v = std::nearbyint(v); break;
      // Far beyond what a float lane holds without rounding.
      case Numbers::wild_whole: v = std::nearbyint(v * 1e4 + (random.chance(0.01) ? 1e9 : 0)); break;
      case Numbers::halves: v = std::nearbyint(v * 8) / 8; break;
      case Numbers::floats: v = static_cast<double>(static_cast<float>(v / 3)); break;
      case Numbers::doubles: v = v / 10 + 0.1; break;
    }
  }
  switch (random.between(0, 5)) {
    case 0: return void_blobs(std::move(terrain), random.between(1, 4), seed);
    case 1: return random_voids(std::move(terrain), random.log_between(1e-4, 0.9), seed);
    case 2: return void_diagonals(std::move(terrain), random.between(2, 40));
    default: return terrain;
  }
}

TEST(VertexError, FastKernelsAgreeWithThePlainLoop) {
  for (std::uint64_t seed = 1; seed <= 250; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto numbers = static_cast<Numbers>(random.between(0, 4));
    // Mostly small; now and then wide enough for a full set of lanes, and one more block.
    const bool wide = seed % 25 == 0;
    const int cols = wide ? random.between(500, 720) : random.between(1, random.chance(0.2) ? 5 : 200);
    const int rows = wide ? random.between(66, 140) : random.between(1, random.chance(0.2) ? 5 : 200);
    const GridPoint first =
        random.chance(0.4) ? GridPoint{0, 0} : GridPoint{random.between(-300, 300), random.between(-300, 300)};
    const HeightStep step = random.chance(0.3) ? HeightStep{1, 10, 0, true} : HeightStep{};
    expect_fast_is_reference(Field(random_terrain(random, numbers, cols, rows), first, step));
    if (HasFailure()) return;
  }
}

TEST(VertexError, ReliefThatOverflowsFloatLanesGoesThroughInDouble) {
  // Twenty kilometres and a millimetre, in millimetres: the nearest float is a rung of the ladder, the error is not.
  Terrain terrain = plane(65, 65, 0, 0, 0);
  terrain.at(31, 17) = 20000001;
  const Field field(terrain, {0, 0}, HeightStep{1, 1000, 0, true});
  expect_fast_is_reference(field);
  const LevelGrid<ErrorCode> errors = vertex_errors(field.input);
  EXPECT_EQ((errors[{31, 17}]), error_code(20000.001));
  EXPECT_NE(error_code(20000.001), error_code(20000));
  expect_fast_is_reference(Field(checkerboard(130, 130, -2147483648.0, 2147483647.0)));
}

TEST(VertexError, ThinRastersAreNoSpecialCase) {
  for (const auto& [cols, rows] : {std::pair{1, 1}, {1, 200}, {200, 1}, {2, 130}, {130, 2}, {65, 3}}) {
    expect_fast_is_reference(Field(whole(noise(cols, rows, 3)), {-64, -65}));
  }
}

TEST(VertexError, LooksAtEverySampleOfTheDiamondNotAtItsMidpoint) {
  // Heights 0, 1.5, 1, 0.5, 0 along every row: the middle is off by 1, the first quarter by 1.5.
  const double profile[] = {0, 1.5, 1, 0.5, 0};
  const Field field(surface(8, 8, [&](int col, int) { return col < 5 ? profile[col] : 0.0; }));
  const LevelGrid<ErrorCode> errors = reference_errors(field.input);
  EXPECT_EQ(error_of(errors[{2, 4}]), 1.5);
}

TEST(VertexError, ASpikeIsTheErrorOfEveryDiamondAroundItButItsOwnHalf) {
  const Field field(spike(64, 64, 21, 34, 50));
  LevelGrid<ErrorCode> errors = vertex_errors(field.input);
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
  EXPECT_EQ(finest_error(5, 1, 2, metres, true), 3.5);
  EXPECT_EQ(finest_error(-5, 1, 2, metres, true), 6.5);
  EXPECT_EQ(finest_error(1.5, 1, 2, metres, true), 0);
}

TEST(FinestError, CarriesTheMarginOnlyWhereItIsNotExactlyZero) {
  const CodeDistance metres;
  EXPECT_EQ(finest_error(1.5, 1, 2, metres, false), 0);
  EXPECT_EQ(finest_error(2.5, 1, 2, metres, false), 1 + kRoundingMargin);
  // The sum rounds to twice the middle, but is not it.
  EXPECT_EQ(finest_error(0.5, 1, 0x1p-60, metres, false), kRoundingMargin);
}

TEST(FinestError, AgreesWithTheErrorOfEveryFinestSideMidpoint) {
  Random random(5);
  for (const bool decimals : {false, true}) {
    Terrain terrain = noise(70, 70, 9, -10, 10);
    for (double& v : terrain.values) v = decimals ? v : std::nearbyint(v);
    const Field field(terrain, {-3, 5});
    LevelGrid<ErrorCode> errors = vertex_errors(field.input);
    saturate(field.input, errors);
    for_each_point(field.extent, [&](GridPoint p) {
      if (spacing(p) != 1 || is_centre(p)) return;
      const Diamond d = diamond(p);
      // A midpoint of the raster's own side has one half; one whose ends are missing has none.
      if (!inside(half_diamond(p, 0), field.extent) && !inside(half_diamond(p, 1), field.extent)) return;
      const HeightField& h = field.input.field;
      EXPECT_EQ(errors[p], error_code(finest_error(h[p], h[d.ends[0]], h[d.ends[1]], h.distance, h.exact)))
          << name_of(p);
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
