// What counts as data, against brute force over the finest triangles.

#include "engine/voids.hpp"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/engine/fields.hpp"
#include "tests/support/oracle.hpp"

namespace talus::support {
namespace {

Terrain random_holes(Random& random, int most = 60) {
  Terrain terrain = noise(random.between(1, most), random.between(1, most), random.next(), 1, 100);
  switch (random.between(0, 3)) {
    case 0: return void_blobs(std::move(terrain), 2, random.next());
    case 1: return random_voids(std::move(terrain), random.log_between(1e-3, 0.95), random.next());
    case 2: return void_diagonals(std::move(terrain), random.between(2, 20));
    default: return hole(std::move(terrain), 3, 5, 30, 20);
  }
}

GridPoint random_origin(Random& random) { return {random.between(-70, 70), random.between(-70, 70)}; }

/// The finest triangles of an extent: halves of unit cells, cut between corners of an even sum.
struct Finest {
  Triangle corners;
  bool valid;
};
template <class Visit>
void for_each_finest(const Field& field, Visit&& visit) {
  for_each_point(field.extent, [&](GridPoint p) {
    if (p.col == field.extent.last.col || p.row == field.extent.last.row) return;
    const GridPoint nw = p, ne{p.col + 1, p.row}, sw{p.col, p.row + 1}, se{p.col + 1, p.row + 1};
    const bool falling = ((p.col + p.row) & 1) == 0;
    const std::array<Triangle, 2> halves = falling ? std::array{Triangle{ne, nw, se}, Triangle{sw, nw, se}}
                                                   : std::array{Triangle{nw, ne, sw}, Triangle{se, ne, sw}};
    for (const Triangle& t : halves) {
      const auto valid = [&](GridPoint q) { return field.valid[field.index(q)] != 0; };
      visit(Finest{t, valid(t.apex) && valid(t.left) && valid(t.right)});
    }
  });
}

/// The middle of a finest triangle, in sixths of a cell, inside a larger triangle of the hierarchy.
bool is_within(const Triangle& small, GridPoint a, GridPoint b, GridPoint c) {
  const int col = small.apex.col + small.left.col + small.right.col,
            row = small.apex.row + small.left.row + small.right.row;
  const auto cross = [&](GridPoint p, GridPoint q) {
    return (q.col - p.col) * (row - 3 * p.row) - (q.row - p.row) * (col - 3 * p.col);
  };
  const int one = cross(a, b), two = cross(b, c), three = cross(c, a);
  return (one > 0 && two > 0 && three > 0) || (one < 0 && two < 0 && three < 0);
}

TEST(Voids, HalvesHoldWhatTheirFinestTrianglesAre) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Field field(random_holes(random, 34), random_origin(random));
    const VoidMap voids(field.extent, field.valid);
    const LevelGrid<std::uint8_t> places(field.extent, 0);
    for_each_vertex(places, [&](GridPoint p) {
      int expected[2] = {kNothing, kNothing};
      if (spacing(p) > 32) return;
      const Diamond d = diamond(p);
      for_each_finest(field, [&](const Finest& f) {
        for (const std::size_t side : {0u, 1u}) {
          if (is_within(f.corners, d.apexes[side], d.ends[0], d.ends[1])) expected[side] |= f.valid ? kData : kVoid;
        }
      });
      for (const int side : {0, 1}) EXPECT_EQ(voids.half(p, side), expected[side]) << name_of(p) << " side " << side;
    });
    if (HasFailure()) return;
  }
}

TEST(Voids, ApexTrianglesWithDataAreThoseThatHoldAValidFinestOne) {
  for (std::uint64_t seed = 31; seed <= 45; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Field field(random_holes(random, 34), random_origin(random));
    const VoidMap voids(field.extent, field.valid);
    for_each_point(field.extent, [&](GridPoint p) {
      if (spacing(p) > 32) return;
      unsigned expected = 0;
      const auto triangles = apex_triangles(p);
      for_each_finest(field, [&](const Finest& f) {
        for (std::size_t i = 0; i < 4; ++i) {
          if (f.valid && is_within(f.corners, triangles[i].apex, triangles[i].left, triangles[i].right))
            expected |= 1u << i;
        }
      });
      EXPECT_EQ(voids.apex_triangles_with_data(p), expected) << name_of(p);
    });
    if (HasFailure()) return;
  }
}

// ---- fill ------------------------------------------------------------------------------------------

TEST(FillVoids, GivesANeededVoidTheHeightOfAValidSampleOfItsDiamond) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Terrain terrain = random_holes(random);
    if (!terrain.has_voids()) continue;
    const Field field(terrain, random_origin(random));
    for_each_point(field.extent, [&](GridPoint p) {
      const double height = field.heights[field.index(p)];
      if (field.valid[field.index(p)] != 0) {
        EXPECT_EQ(height, terrain.values[field.index(p)]) << "data must stay: " << name_of(p);
        return;
      }
      if (spacing(p) == kRootSpacing) return;
      if (field.voids->apex_triangles_with_data(p) == 0) {
        EXPECT_EQ(height, 0) << name_of(p);
        return;
      }
      double lowest = 1e9, highest = -1e9;
      bool found = false;
      for (const int side : {0, 1}) {
        const HalfDiamond t = half_diamond(p, side);
        for (std::int32_t row = t.top(); row <= t.bottom(); ++row) {
          for (std::int32_t col = t.columns(row).lo; col <= t.columns(row).hi; ++col) {
            if (!field.extent.contains({col, row}) || field.valid[field.index({col, row})] == 0) continue;
            const double h = terrain.values[field.index({col, row})];
            lowest = std::min(lowest, h);
            highest = std::max(highest, h);
            found = found || h == height;
          }
        }
      }
      EXPECT_TRUE(found) << name_of(p) << " has " << height << ", no valid sample of its diamond";
      EXPECT_GE(height, lowest);
      EXPECT_LE(height, highest);
    });
    if (HasFailure()) return;
  }
}

TEST(FillVoids, TakesTheSampleNearestToTheMiddleOfTheRange) {
  // The square around the void has 10, 40, 52 and 90: the middle of 10 and 90 is 50.
  Terrain terrain = plane(5, 5, 40, 0, 0);
  terrain.make_void(2, 2);
  terrain.at(1, 1) = 10;
  terrain.at(3, 0) = 90;
  terrain.at(0, 3) = 52;
  const Field field(terrain);
  EXPECT_EQ(field.heights[field.index({2, 2})], 52);
}

TEST(FillVoids, DoesNotLookBeyondTheDiamond) {
  Random random(8);
  Terrain terrain = random_voids(noise(40, 40, 3, 1, 100), 0.2, 5);
  const Field before(terrain);
  const GridPoint changed{37, 38};
  if (terrain.is_valid(changed.col, changed.row)) terrain.at(changed.col, changed.row) = 1e6;
  const Field after(terrain);
  for_each_point(before.extent, [&](GridPoint p) {
    if (spacing(p) == kRootSpacing || std::max(changed.col - p.col, changed.row - p.row) <= spacing(p)) return;
    EXPECT_EQ(before.heights[before.index(p)], after.heights[after.index(p)]) << name_of(p);
  });
}

TEST(FillVoids, ARootCornerTakesACoveredSampleNearIt) {
  const Field field(hole(plane(40, 40, 7, 0, 0), 0, 0, 20, 20));
  EXPECT_EQ(field.heights[0], 7);
}

}  // namespace
}  // namespace talus::support
