// Closing a set under parents: both algorithms, against the definition.

#include "engine/quadtree/construction.hpp"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error/saturation.hpp"
#include "engine/quadtree/border.hpp"
#include "tests/engine/closed_sets.hpp"
#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

using Points = std::set<Point>;

/// All that the wanted vertices depend on, by recursion; what lies in the region.
Points closure(const Points& wanted, GridRect region, std::int32_t root) {
  Points all, inside;
  const auto add = [&](auto&& self, GridPoint p) -> void {
    if (!all.insert(key(p)).second || spacing(p) >= root) return;
    for (const GridPoint parent : diamond(p).apexes) self(self, parent);
  };
  for (const Point& p : wanted) add(add, point(p));
  for (const Point& p : all) {
    if (region.contains(point(p))) inside.insert(p);
  }
  return inside;
}

/// The members as for_each and contains see them.
Points members(VertexMask& mask) {
  Points found, contained;
  mask.for_each([&](GridPoint p) { found.insert(key(p)); });
  for_each_point(mask.region(), [&](GridPoint p) {
    if (mask.contains(p)) contained.insert(key(p));
  });
  EXPECT_EQ(found, contained) << "bits beyond the last column";
  return found;
}

Points bottom_up(const Points& wanted, GridRect region, std::int32_t root) {
  VertexMask mask(region);
  for (const Point& p : wanted) mask.insert(point(p));
  const std::size_t added = close_bottom_up(mask, root);
  const Points closed = members(mask);
  EXPECT_EQ(closed.size(), wanted.size() + added);
  return closed;
}

/// `any` says what the descent is told of a square in which nothing is wanted.
Points top_down(const Points& wanted, GridRect region, std::int32_t root, bool any = false) {
  const auto any_wanted = [&](GridPoint centre) {
    const std::int32_t s = spacing(centre);
    const GridRect square{{centre.col - s, centre.row - s}, {centre.col + s, centre.row + s}};
    return any || std::any_of(wanted.begin(), wanted.end(), [&](Point p) { return square.contains(point(p)); });
  };
  VertexMask mask = close_top_down(
      region, root, [&](GridPoint p) { return wanted.contains(key(p)); }, any_wanted);
  return members(mask);
}

/// Lengths that end before, on and after a word, a power of two, or nothing in particular.
int random_length(Random& random, int most) {
  switch (random.between(0, 3)) {
    case 0: return 1;
    case 1: return std::min(most, (1 << random.between(0, 7)) + random.between(-1, 1) + 1);
    case 2: return std::min(most, 64 * random.between(1, 3) + random.between(-1, 2));
    default: return random.between(1, most);
  }
}

GridRect random_region(Random& random, int most) {
  const int reach = 1 << random.between(0, 9);
  GridPoint first{random.between(-reach, reach), random.between(-reach, reach)};
  if (random.chance(0.3)) first = {first.col & -16, first.row & -16};
  return {first,
          {first.col + std::max(1, random_length(random, most)) - 1,
           first.row + std::max(1, random_length(random, most)) - 1}};
}

Points random_wanted(Random& random, GridRect region) {
  Points wanted;
  if (random.chance(0.6)) {
    for (int i = random.between(0, 20); i > 0; --i) wanted.insert(key(random_point(random, region)));
    return wanted;
  }
  const double density = random.log_between(1e-3, 1);
  for_each_point(region, [&](GridPoint p) {
    if (random.chance(density)) wanted.insert(key(p));
  });
  return wanted;
}

TEST(Construction, BothAlgorithmsGiveTheClosure) {
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_region(random, 150);
    const std::int32_t root = root_side(region);
    const Points wanted = random_wanted(random, region), expected = closure(wanted, region, root);
    ASSERT_EQ(bottom_up(wanted, region, root), expected);
    ASSERT_EQ(top_down(wanted, region, root, wanted.size() > 50), expected);
  }
}

TEST(Construction, TheResultIsClosedWithinTheRegion) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_region(random, 150);
    const std::int32_t root = root_side(region);
    const Points closed = bottom_up(random_wanted(random, region), region, root);
    for (const Point& p : closed) {
      if (spacing(point(p)) >= root) continue;
      for (const GridPoint parent : diamond(point(p)).apexes) {
        if (region.contains(parent)) {
          ASSERT_TRUE(closed.contains(key(parent))) << name_of(parent) << " of " << name_of(point(p));
        }
      }
    }
    EXPECT_EQ(bottom_up(closed, region, root), closed) << "closed twice is closed once";
  }
}

TEST(Construction, EachVertexIsWantedOrNeededByOneThatIs) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_region(random, 40);
    const std::int32_t root = root_side(region);
    Points wanted;
    for (int i = random.between(1, 8); i > 0; --i) wanted.insert(key(random_point(random, region)));
    // A member that is neither would be missing from the union of what each wanted vertex needs alone.
    Points needed;
    for (const Point& p : wanted) needed.merge(closure({p}, region, root));
    EXPECT_EQ(bottom_up(wanted, region, root), needed);
    EXPECT_EQ(top_down(wanted, region, root), needed);
  }
}

TEST(Construction, NothingWantedGivesNothing) {
  for (const GridRect region : {GridRect{{0, 0}, {0, 0}}, {{-70, -3}, {90, 8}}, {{0, 0}, {-1, -1}}}) {
    EXPECT_TRUE(bottom_up({}, region, 128).empty());
    EXPECT_TRUE(top_down({}, region, 128, true).empty());
  }
}

TEST(Construction, AParentBeyondTheRegionBringsItsOwnParentsBackIn) {
  // In a region of one column, (4, 1) has its parents (3, 1) and (5, 1) beyond it; both stand on (4, 2), whose parents
  // (2, 2) and (6, 2) stand on (4, 0), which stands on (4, 4).
  const GridRect column{{4, 0}, {4, 8}};
  const Points expected{{4, 0}, {4, 1}, {4, 2}, {4, 4}};
  EXPECT_EQ(bottom_up({{4, 1}}, column, 16), expected);
  EXPECT_EQ(top_down({{4, 1}}, column, 16), expected);
}

TEST(Construction, ARegionGivesWhatALargerOneGivesThere) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_region(random, 60);
    const GridRect larger{{region.first.col - random.between(0, 90), region.first.row - random.between(0, 90)},
                          {region.last.col + random.between(0, 90), region.last.row + random.between(0, 90)}};
    const std::int32_t root = root_side(larger);
    const Points wanted = random_wanted(random, region);
    Points there;
    for (const Point& p : bottom_up(wanted, larger, root)) {
      if (region.contains(point(p))) there.insert(p);
    }
    EXPECT_EQ(bottom_up(wanted, region, root), there);
    // A larger root adds nothing but ancestors above the smaller one.
    const Points below = bottom_up(wanted, region, 4 * root);
    for (const Point& p : there) EXPECT_TRUE(below.contains(p)) << name_of(point(p));
  }
}

TEST(Construction, ABorderIsClosedAlready) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_region(random, 120);
    const std::int32_t root = root_side(region);
    Points border;
    for (const GridPoint p : border_vertices(region, root)) border.insert(key(p));
    EXPECT_EQ(bottom_up(border, region, root), border);
  }
}

TEST(Construction, ClosingRawErrorsIsAThresholdOnSaturatedOnes) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Terrain terrain = fractal(random.between(2, 140), random.between(2, 140), random.next());
    for (double& v : terrain.values) v = std::nearbyint(v);
    const Field field(terrain, {random.between(-150, 20), random.between(-150, 20)});
    const std::int32_t root = root_side(field.extent);
    const LevelGrid<ErrorCode> raw = reference_errors(field.input, field.levels());
    LevelGrid<ErrorCode> saturated = raw;
    saturate(field.input, saturated);
    const ErrorCode threshold = error_code(random.log_between(0.1, 300));
    const auto above = [&](const LevelGrid<ErrorCode>& errors) {
      Points found;
      for_each_point(field.extent, [&](GridPoint p) {
        if (spacing(p) >= root || errors[p] > threshold) found.insert(key(p));
      });
      return found;
    };
    EXPECT_EQ(bottom_up(above(raw), field.extent, root), above(saturated));
    // Nothing in a square has a larger saturated error than its centre, so that alone says where to descend.
    const auto is_above = [&](GridPoint p) { return spacing(p) >= root || saturated[p] > threshold; };
    VertexMask descended = close_top_down(field.extent, root, is_above, is_above);
    EXPECT_EQ(members(descended), above(saturated));
  }
}

}  // namespace
}  // namespace talus::support
