// Saturation: a threshold alone must select a set closed under parents, and zero must mean zero.

#include "engine/error/saturation.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

LevelGrid<ErrorCode> saturated(const Field& field) {
  LevelGrid<ErrorCode> errors = reference_errors(field.input, field.levels());
  saturate(field.input, errors);
  return errors;
}

/// Terrains whose numbers round or do not, with voids or without.
Terrain random_terrain(Random& random) {
  const int cols = random.between(1, 150), rows = random.between(1, 150);
  Terrain terrain = random.chance(0.5) ? fractal(cols, rows, random.next()) : plateaus(cols, rows);
  const bool rounds = random.chance(0.5);
  for (double& v : terrain.values) v = rounds ? v / 10 : std::nearbyint(v);
  return random.chance(0.4) ? void_blobs(std::move(terrain), 3, random.next()) : terrain;
}

TEST(Saturation, NoVertexIsBelowItsChild) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Field field(random_terrain(random), {random.between(-100, 0), random.between(-100, 0)});
    const LevelGrid<ErrorCode> errors = saturated(field);
    for_each_vertex(errors, [&](GridPoint p) {
      if (!field.extent.contains(p)) return;
      for (const GridPoint parent : diamond(p).apexes) {
        if (errors.holds(parent)) {
          EXPECT_GE(errors[parent], errors[p]) << name_of(parent) << " above " << name_of(p);
        }
      }
    });
    if (HasFailure()) return;
  }
}

TEST(Saturation, EveryErrorIsItsOwnOrSomeDescendants) {
  Random random(4);
  const Field field(random_terrain(random));
  const LevelGrid<ErrorCode> raw = reference_errors(field.input, field.levels()), errors = saturated(field);
  for_each_vertex(errors, [&](GridPoint p) {
    const Children below = children(p);
    ErrorCode largest = raw[p];
    for (int i = 0; i < below.count; ++i) {
      const GridPoint child = below.at[static_cast<std::size_t>(i)];
      if (errors.holds(child)) largest = std::max(largest, errors[child]);
    }
    EXPECT_LE(errors[p], largest) << name_of(p);
  });
}

/// All covered samples of the diamond lie on the two triangles: compared in a wider number.
bool is_interpolated(const Field& field, GridPoint p) {
  for (const int side : {0, 1}) {
    const HalfDiamond t = half_diamond(p, side);
    if (!inside(t, field.extent)) continue;
    using Wide = long double;
    const auto at = [&](GridPoint q) { return static_cast<Wide>(field.input.field[q]); };
    const Wide n = static_cast<Wide>((t.a.col - t.apex.col) * (t.b.row - t.apex.row) -
                                     (t.b.col - t.apex.col) * (t.a.row - t.apex.row));
    for (std::int32_t row = t.top(); row <= t.bottom(); ++row) {
      const auto [lo, hi] = t.columns(row);
      for (std::int32_t col = lo; col <= hi; ++col) {
        const Wide u = static_cast<Wide>((col - t.apex.col) * (t.b.row - t.apex.row) -
                                         (t.b.col - t.apex.col) * (row - t.apex.row));
        const Wide v = static_cast<Wide>((t.a.col - t.apex.col) * (row - t.apex.row) -
                                         (col - t.apex.col) * (t.a.row - t.apex.row));
        // n is a power of two up to its sign: eleven more bits than a double make the sums exact here.
        if (at(t.apex) * (n - u - v) + at(t.a) * u + at(t.b) * v != n * at({col, row})) return false;
      }
    }
  }
  return true;
}

TEST(Saturation, ZeroIsExactlyInterpolatedAndNothingElseIsZero) {
  // 0.1 is no binary fraction: planes of tenths are met exactly in places and missed by an ulp in others.
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const int kind = random.between(0, 3);
    Terrain terrain = surface(random.between(2, 70), random.between(2, 70), [&](int col, int row) {
      switch (kind) {
        case 0: return 0.1;
        case 1: return (col + 2 * row) / 10.0;
        case 2: return static_cast<double>(static_cast<float>((3 * col + row) / 10.0));
        default: return col % 16 < 12 ? 1.1 : 0.1 * col;
      }
    });
    const Field field(terrain, {random.between(-50, 0), random.between(-50, 0)});
    const LevelGrid<ErrorCode> errors = saturated(field);
    std::size_t zeros = 0;
    // Bottom up: zero iff nothing below has an error and the vertex itself has none.
    for_each_vertex(errors, [&](GridPoint p) {
      if (!field.extent.contains(p)) return;
      const bool in = inside(half_diamond(p, 0), field.extent) || inside(half_diamond(p, 1), field.extent);
      if (!in) return;
      const bool all = inside(half_diamond(p, 0), field.extent) && inside(half_diamond(p, 1), field.extent);
      if (errors[p] == 0) {
        EXPECT_TRUE(is_interpolated(field, p)) << name_of(p);
        ++zeros;
      } else if (all && spacing(p) == 1) {
        EXPECT_FALSE(is_interpolated(field, p)) << name_of(p);
      }
    });
    if (kind == 0) {
      EXPECT_GT(zeros, 0u);
    }
    if (HasFailure()) return;
  }
}

TEST(Saturation, AFlatDecimalTerrainHasNoErrorAnywhere) {
  const Field field(plane(70, 50, 0.1, 0, 0));
  const LevelGrid<ErrorCode> errors = saturated(field);
  for_each_vertex(errors, [&](GridPoint p) { EXPECT_EQ(errors[p], 0) << name_of(p); });
}

/// The largest code of a vertex and all that hang below it, by plain recursion: a side midpoint's children are the four
/// centres of half its spacing around it, a centre's the four side midpoints of its square.
/// known: -1 where nothing was found yet.
ErrorCode largest_below(const LevelGrid<ErrorCode>& errors, GridPoint p, LevelGrid<std::int32_t>& known) {
  if (!errors.holds(p)) return 0;
  if (known[p] >= 0) return static_cast<ErrorCode>(known[p]);
  std::int32_t s = 1;
  while (p.col % (2 * s) == 0 && p.row % (2 * s) == 0) s *= 2;
  const bool centre = p.col % (2 * s) != 0 && p.row % (2 * s) != 0;
  ErrorCode largest = errors[p];
  const std::int32_t far = centre ? s : s / 2;  // none: it is one of the finest
  for (const std::int32_t dx : {-1, 0, 1}) {
    for (const std::int32_t dy : {-1, 0, 1}) {
      if (far == 0 || (dx != 0) + (dy != 0) != (centre ? 1 : 2)) continue;
      largest = std::max(largest, largest_below(errors, {p.col + dx * far, p.row + dy * far}, known));
    }
  }
  known[p] = largest;
  return largest;
}

TEST(Saturation, OfAnyCodesIsTheLargestOfAllDescendants) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const int cols = random.between(1, 60), rows = random.between(1, 60);
    // Whole numbers are gathered by kernels, others one by one; none is exactly zero, so that nothing becomes so.
    Terrain terrain = noise(cols, rows, seed, 1, 1000);
    const bool rounds = random.chance(0.5);
    if (!rounds) {
      for (double& v : terrain.values) v = std::nearbyint(v);
    }
    const Field field(terrain, {random.between(-100, 40), random.between(-100, 40)});
    LevelGrid<ErrorCode> raw(field.extent, kTileLevels, 0);
    const double density = random.unit();
    for_each_vertex(raw, [&](GridPoint p) {
      if (random.chance(density)) raw[p] = static_cast<ErrorCode>(random.between(1, kLastFiniteError));
    });
    LevelGrid<ErrorCode> errors = raw;
    saturate(field.input, errors);
    LevelGrid<std::int32_t> known(field.extent, kTileLevels, -1);
    std::size_t different = 0;
    for_each_vertex(raw, [&](GridPoint p) {
      const ErrorCode expected = largest_below(raw, p, known);
      if (errors[p] != expected && ++different <= 3)
        ADD_FAILURE() << name_of(p) << ": " << errors[p] << ", not " << expected;
    });
    EXPECT_EQ(different, 0u);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace talus::support
