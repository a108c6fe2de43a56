// What counts as data, against brute force over the finest triangles.

#include "engine/error/voids.hpp"

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
    const VoidMap voids(field.extent, field.valid, kTileLevels);
    const LevelGrid<std::uint8_t> places(field.extent, kTileLevels, 0);
    for_each_vertex(places, [&](GridPoint p) {
      int expected[2] = {kNothing, kNothing};
      if (spacing(p) > 32) return;
      const Diamond d = diamond(p);
      for_each_finest(field, [&](const Finest& f) {
        for (const std::size_t side : {0u, 1u}) {
          if (is_within(f.corners, d.apexes[side], d.ends[0], d.ends[1])) expected[side] |= f.valid ? kData : kVoid;
        }
      });
      for (const int side : {0, 1}) {
        const bool in = inside(half_diamond(p, side), field.extent);  // one that leaves the extent holds nothing
        EXPECT_EQ(voids.half(p, side), in ? expected[side] : kNothing) << name_of(p) << " side " << side;
      }
    });
    if (HasFailure()) return;
  }
}

TEST(Voids, ApexTrianglesWithDataAreThoseThatHoldAValidFinestOne) {
  for (std::uint64_t seed = 31; seed <= 45; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Field field(random_holes(random, 34), random_origin(random));
    const VoidMap voids(field.extent, field.valid, kTileLevels);
    for_each_point(field.extent, [&](GridPoint p) {
      if (spacing(p) > 32) return;
      unsigned expected = 0;
      const auto triangles = apex_triangles(p);
      for_each_finest(field, [&](const Finest& f) {
        for (std::size_t i = 0; i < 4; ++i) {
          const auto in = [&](GridPoint q) { return field.extent.contains(q); };
          if (f.valid && in(triangles[i].apex) && in(triangles[i].left) && in(triangles[i].right) &&
              is_within(f.corners, triangles[i].apex, triangles[i].left, triangles[i].right))
            expected |= 1u << i;
        }
      });
      EXPECT_EQ(voids.apex_triangles_with_data(p), expected) << name_of(p);
    });
    if (HasFailure()) return;
  }
}

// ---- fill ------------------------------------------------------------------------------------------

/// A field with the fills of fill_voids.
struct Filled {
  explicit Filled(const Terrain& terrain, GridPoint first = {0, 0})
      : field(terrain, first), codes(codes_of(terrain.values)), voids(field.extent, field.valid, kTileLevels) {
    fill_voids(field.extent, field.valid, voids, field.extent, codes);
  }
  [[nodiscard]] double at(GridPoint p) const { return code_at(view(codes), field.index(p)); }
  Field field;  ///< filled by plain loops
  Codes codes;
  VoidMap voids;
};

TEST(FillVoids, FollowsTheRule) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Terrain terrain = random_holes(random, seed % 10 == 0 ? 200 : 60);
    if (!terrain.has_voids()) continue;
    const Filled filled(terrain, random_origin(random));
    for_each_point(filled.field.extent,
                   [&](GridPoint p) { EXPECT_EQ(filled.at(p), filled.field.input.field[p]) << name_of(p); });
    if (HasFailure()) return;
  }
}

TEST(FillVoids, TakesTheSampleNearestToTheMiddleOfTheRange) {
  // The square around the void has 10, 40, 52 and 90: the middle of 10 and 90 is 50.
  Terrain terrain = plane(5, 5, 40, 0, 0);
  terrain.make_void(2, 2);
  terrain.at(1, 1) = 10;
  terrain.at(3, 1) = 90;
  terrain.at(1, 3) = 52;
  terrain.at(0, 0) = 49;  // farther away than others that are valid
  EXPECT_EQ(Filled(terrain).at({2, 2}), 52);
}

TEST(FillVoids, GivesVerticesAboveTheLevelsAFillIfDataIsNear) {
  Terrain terrain = hole(plane(200, 40, 7, 0, 0), 0, 0, 63, 39);
  EXPECT_EQ(Filled(terrain).at({0, 0}), 7);
  terrain = hole(plane(200, 40, 7, 0, 0), 0, 0, 64, 39);
  EXPECT_EQ(Filled(terrain).at({0, 0}), 0);
}

TEST(FillVoids, ChangesOnlyTheVoidsOfItsRectangle) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Terrain terrain = random_holes(random);
    if (!terrain.has_voids()) continue;
    const Field field(terrain, random_origin(random));
    const GridPoint first{random.between(field.extent.first.col - 9, field.extent.last.col),
                          random.between(field.extent.first.row - 9, field.extent.last.row)};
    const GridRect within{first, {first.col + random.between(-1, 40), first.row + random.between(0, 40)}};
    Codes codes = codes_of(terrain.values);
    std::visit(
        [&](auto& all) {
          for (std::size_t i = 0; i < all.size(); ++i) {
            if (field.valid[i] == 0) all[i] = 77;
          }
        },
        codes);
    const VoidMap voids(field.extent, field.valid, kTileLevels);
    fill_voids(field.extent, field.valid, voids, within, codes);
    for_each_point(field.extent, [&](GridPoint p) {
      const bool is_void = field.valid[field.index(p)] == 0;
      const double expected = is_void && !within.contains(p) ? 77 : field.input.field[p];
      EXPECT_EQ(code_at(view(codes), field.index(p)), expected) << name_of(p);
    });
    if (HasFailure()) return;
  }
}

TEST(Voids, DataIsNearIfASampleLiesWithinReach) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridPoint first = random_origin(random);
    const GridRect extent{first, {first.col + random.between(0, 150), first.row + random.between(0, 150)}};
    std::vector<std::uint8_t> valid(static_cast<std::size_t>(extent.samples()), 0);
    const GridPoint sample{random.between(extent.first.col, extent.last.col),
                           random.between(extent.first.row, extent.last.row)};
    valid[static_cast<std::size_t>((sample.row - first.row) * extent.cols() + (sample.col - first.col))] = 1;
    for_each_point(extent, [&](GridPoint p) {
      const bool expected = std::abs(p.col - sample.col) <= 64 && std::abs(p.row - sample.row) <= 64;
      ASSERT_EQ(has_data_near(extent, valid, p), expected) << name_of(p) << " and " << name_of(sample);
    });
  }
}

TEST(Voids, AMapThatIsSetAgainIsAsOneMadeAnew) {
  Random random(8);
  VoidMap again({{0, 0}, {0, 0}}, std::vector<std::uint8_t>{1}, 1);
  for (int time = 0; time < 20; ++time) {
    const Field field(random_holes(random), random_origin(random));
    const VoidMap anew(field.extent, field.valid, kTileLevels);
    again.reset(field.extent, field.valid, kTileLevels);
    EXPECT_EQ(again.levels(), anew.levels());
    for_each_point(field.extent, [&](GridPoint p) {
      ASSERT_EQ(again.holds(p), anew.holds(p));
      if (!anew.holds(p)) return;
      for (const int side : {0, 1}) ASSERT_EQ(again.half(p, side), anew.half(p, side));
      ASSERT_EQ(again.apex_triangles_with_data(p), anew.apex_triangles_with_data(p));
      const std::int32_t s = spacing(p);
      const std::uint8_t units = again.units(height_in_tree(p)).at(p.col / s, p.row / s);
      ASSERT_EQ(units, anew.half(p, 0) | anew.half(p, 1) << 2);
    });
  }
}

}  // namespace
}  // namespace talus::support
