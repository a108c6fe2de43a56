// Planes near the samples of blocks, and distances over large triangles, against loops over all samples.

#include "engine/error/slab_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/page/page_layout.hpp"
#include "tests/engine/fields.hpp"
#include "tests/engine/terrains.hpp"

namespace talus::support {
namespace {

GridRect blocks_of(GridRect extent) {
  return {{extent.first.col >> 6, extent.first.row >> 6}, {extent.last.col >> 6, extent.last.row >> 6}};
}

/// The samples that a block owns, or one of its slabs.
template <class Visit>
void for_each_valid(const Field& field, GridPoint corner, int side, Visit&& visit) {
  for_each_point({corner, {corner.col + side - 1, corner.row + side - 1}}, [&](GridPoint p) {
    if (field.extent.contains(p) && field.valid[field.index(p)] != 0) visit(p, field.input.field[p]);
  });
}

void expect_shape(const Field& field, GridPoint corner, const detail::BlockShape& shape) {
  SCOPED_TRACE("block at " + name_of(corner));
  std::vector<double> heights;
  const auto on_plane = [&](GridPoint p) {
    return static_cast<double>(shape.middle) + static_cast<double>(shape.right) * (p.col - corner.col - 32) +
           static_cast<double>(shape.down) * (p.row - corner.row - 32);
  };
  for_each_valid(field, corner, 64, [&](GridPoint p, double h) {
    heights.push_back(h);
    EXPECT_LE(h - on_plane(p), static_cast<double>(shape.above)) << name_of(p);
    EXPECT_LE(on_plane(p) - h, static_cast<double>(shape.below)) << name_of(p);
  });
  ASSERT_EQ(shape.has_data, !heights.empty());
  if (heights.empty()) return;
  std::sort(heights.begin(), heights.end());
  const double middle = heights.front() + (heights.back() - heights.front()) / 2;
  double typical = heights.front();
  for (const double h : heights) {
    if (std::abs(h - middle) < std::abs(typical - middle)) typical = h;
  }
  EXPECT_EQ(shape.typical, typical);
  // A plane that is far off would be sound, too, but of no use.
  const double range = heights.back() - heights.front();
  EXPECT_LE(static_cast<double>(shape.above + shape.below), 2.1 * range + 1e-5 * (1 + std::abs(middle)));
  for (int n = 0; n < 64; ++n) {
    const GridPoint slab{corner.col + n % 8 * 8, corner.row + n / 8 * 8};
    const auto low = static_cast<double>(shape.slabs.low[n]), high = static_cast<double>(shape.slabs.high[n]);
    bool any = false;
    // Distances in floats: the bound over the whole block has the rounding.
    const double slack = 1e-5 * (1 + std::abs(middle) + range);
    for_each_valid(field, slab, 8, [&](GridPoint p, double h) {
      any = true;
      EXPECT_GE(h - on_plane(p), low - slack) << name_of(p);
      EXPECT_LE(h - on_plane(p), high + slack) << name_of(p);
    });
    EXPECT_EQ(low <= high, any) << "slab at " << name_of(slab);
  }
}

TEST(SlabErrors, ShapesHoldAllSamplesOfTheirBlocks) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto numbers = static_cast<Numbers>(seed % kNumbers);
    const Field field(random_terrain(random, numbers, random.between(1, 200), random.between(1, 200)),
                      {random.between(-150, 50), random.between(-150, 50)});
    const GridRect inside = blocks_of(field.extent);
    const GridRect blocks{{inside.first.col - 1, inside.first.row}, {inside.last.col, inside.last.row + 1}};
    const std::vector<detail::BlockShape> shapes = detail::block_shapes(field.input.field, blocks);
    ASSERT_EQ(shapes.size(), static_cast<std::size_t>(blocks.samples()));
    std::size_t i = 0;
    for_each_point(blocks, [&](GridPoint b) { expect_shape(field, {b.col * 64, b.row * 64}, shapes[i++]); });
    if (HasFailure()) return;
  }
}

/// Twice the area of a triangle, with its sign.
std::int64_t cross(GridPoint a, GridPoint b, GridPoint c) {
  return (std::int64_t{b.col} - a.col) * (std::int64_t{c.row} - a.row) -
         (std::int64_t{b.row} - a.row) * (std::int64_t{c.col} - a.col);
}

/// The largest distance of any valid sample inside from the plane of three corners: by weights of the corners, which
/// are whole numbers over a power of two.
template <class Number>
double plain_distance(const Field& field, const HalfDiamond& t) {
  const HeightField& f = field.input.field;
  const std::int64_t area = cross(t.apex, t.a, t.b);
  const auto height = [&](GridPoint p) { return static_cast<Number>(f[p]); };
  Number largest = 0;
  const auto [left, right] = std::minmax({t.apex.col, t.a.col, t.b.col});
  const auto [top, bottom] = std::minmax({t.apex.row, t.a.row, t.b.row});
  for_each_point({{left, top}, {right, bottom}}, [&](GridPoint p) {
    std::int64_t one = cross(p, t.a, t.b), two = cross(t.apex, p, t.b), three = cross(t.apex, t.a, p);
    if (area < 0) one = -one, two = -two, three = -three;
    if (one < 0 || two < 0 || three < 0 || field.valid[field.index(p)] == 0) return;
    const Number on_plane = static_cast<Number>(one) * height(t.apex) + static_cast<Number>(two) * height(t.a) +
                            static_cast<Number>(three) * height(t.b);
    const Number apart = static_cast<Number>(std::abs(area)) * height(p) - on_plane;
    largest = std::max(largest, apart < 0 ? -apart : apart);
  });
  return static_cast<double>(largest) / static_cast<double>(std::abs(area));
}

void expect_distances(const Field& field) {
  std::vector<HalfDiamond> halves;
  for_each_point({{field.extent.first.col >> 6, field.extent.first.row >> 6},
                  {field.extent.last.col >> 6, field.extent.last.row >> 6}},
                 [&](GridPoint unit) {
                   const GridPoint p{unit.col * 64, unit.row * 64};
                   if (spacing(p) > 512) return;
                   for (const int side : {0, 1}) {
                     if (inside(half_diamond(p, side), field.extent)) halves.push_back(half_diamond(p, side));
                   }
                 });
  const GridRect blocks = blocks_of(field.extent);
  const auto shapes = detail::block_shapes(field.input.field, blocks);
  std::vector<double> distances(halves.size(), -1);
  detail::largest_distances(field.input.field, shapes, blocks, halves, distances);
  const bool whole = std::holds_alternative<std::vector<std::int16_t>>(field.codes);
  for (std::size_t i = 0; i < halves.size(); ++i) {
    SCOPED_TRACE("vertex " + name_of(halves[i].vertex) + ", apex " + name_of(halves[i].apex));
    if (whole) {
      EXPECT_EQ(distances[i], plain_distance<std::int64_t>(field, halves[i]));
    } else {
      const double expected = plain_distance<long double>(field, halves[i]);
      EXPECT_NEAR(distances[i], expected, 1e-13 * (1 + expected) * 1e5);
    }
  }
}

TEST(SlabErrors, DistancesAreThoseOfAllSamplesInTheTriangles) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Numbers numbers = seed % 2 == 0 ? Numbers::whole : static_cast<Numbers>(seed % kNumbers);
    if (numbers == Numbers::wild_whole || numbers == Numbers::wide_whole) continue;  // compared by other roundings
    const Field field(random_terrain(random, numbers, random.between(130, 420), random.between(130, 420)),
                      {random.between(-150, 50), random.between(-150, 50)});
    expect_distances(field);
    if (HasFailure()) return;
  }
}

TEST(SlabErrors, TheOneSampleThatIsOffIsFoundWhereverItStands) {
  // Nothing else in the triangle can raise the bound above zero: a block or slab that is left out shows.
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Terrain terrain = plane(257, 257, 5, 1, -2);
    const int col = random.chance(0.3) ? 8 * random.between(0, 32) : random.between(0, 256);
    const int row = random.chance(0.3) ? 8 * random.between(0, 32) : random.between(0, 256);
    terrain.at(col, row) += random.chance(0.5) ? 1 : -1;
    expect_distances(Field(terrain));
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace talus::support
