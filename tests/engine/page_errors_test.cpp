// Errors that follow from a page's heights are those of the definition, and fit those that are stored.

#include "engine/page/page_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error/saturation.hpp"
#include "engine/page/page_codec.hpp"
#include "tests/engine/fields.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

// ---- the definition, with no code of the kernel ------------------------------------------------------

/// Twice the signed area.
std::int64_t cross(GridPoint a, GridPoint b, GridPoint c) {
  return (std::int64_t{b.col} - a.col) * (std::int64_t{c.row} - a.row) -
         (std::int64_t{b.row} - a.row) * (std::int64_t{c.col} - a.col);
}

/// visit(sample, surface) for every sample in a closed triangle.
template <class HeightAt, class Visit>
void for_each_under(const std::array<GridPoint, 3>& t, HeightAt&& height, Visit&& visit) {
  const auto [left, right] = std::minmax({t[0].col, t[1].col, t[2].col});
  const auto [top, bottom] = std::minmax({t[0].row, t[1].row, t[2].row});
  const std::int64_t area = cross(t[0], t[1], t[2]);
  for (std::int32_t row = top; row <= bottom; ++row) {
    for (std::int32_t col = left; col <= right; ++col) {
      const GridPoint p{col, row};
      const std::int64_t w[3] = {cross(p, t[1], t[2]), cross(t[0], p, t[2]), cross(t[0], t[1], p)};
      if (std::any_of(w, w + 3, [&](std::int64_t v) { return (v < 0) != (area < 0) && v != 0; })) continue;
      double sum = 0;  // exact: few bits times an area of at most 2^10, which is a power of two
      for (std::size_t k = 0; k < 3; ++k) sum += static_cast<double>(w[k]) * height(t[k]);
      visit(p, sum / static_cast<double>(area));
    }
  }
}

class Definition {
 public:
  explicit Definition(const Field& field) : field_(field) {}
  /// Saturated, in height codes.
  double operator()(GridPoint p) {
    if (const auto known = known_.find({p.col, p.row}); known != known_.end()) return known->second;
    double largest = 0;
    const Diamond d = diamond(p);
    const auto height = [&](GridPoint q) { return field_.input.field[q]; };
    for (const GridPoint apex : d.apexes) {
      if (!field_.extent.contains(apex) || !field_.extent.contains(d.ends[0]) || !field_.extent.contains(d.ends[1]))
        continue;
      for_each_under({apex, d.ends[0], d.ends[1]}, height, [&](GridPoint q, double surface) {
        if (field_.valid[field_.input.field.index(q)] != 0) largest = std::max(largest, std::abs(height(q) - surface));
      });
    }
    const Children below = children(p);
    for (int k = 0; k < below.count; ++k) largest = std::max(largest, (*this)(below.at[static_cast<std::size_t>(k)]));
    return known_[{p.col, p.row}] = largest;
  }

 private:
  const Field& field_;
  std::map<std::pair<std::int32_t, std::int32_t>, double> known_;
};

/// A finest page as ingest makes it, and what the decoder makes of its bytes.
struct Packed {
  /// distance  a code that may be any number: errors are codes where they do not follow from heights
  Packed(const Field& field, PageId id, const CodeDistance& of_codes = {}) : extent(field.extent), distance(of_codes) {
    LevelGrid<ErrorCode> errors = reference_errors(field.input, levels_of(field.extent));
    saturate(field.input, errors);
    given.id = id;
    given.bands = band_count(extent);
    given.grid = page_grid(id, extent);
    for (std::int32_t row = 0; row < given.grid.rows; ++row) {
      for (std::int32_t col = 0; col < given.grid.cols; ++col) {
        const GridPoint p = given.grid.at(col, row);
        given.heights.push_back(field.input.field[p]);
        given.errors.push_back(!given.is_own(p)                       ? ErrorCode{0}
                               : height_in_tree(p) >= errors.levels() ? kAlwaysSelected
                                                                      : errors[p]);
        given.valid.push_back(field.valid[field.input.field.index(p)]);
        given.covers.push_back(given.is_own(p) && field.voids ? field.voids->apex_triangles_with_data(p)
                                                              : std::uint8_t{0});
      }
    }
    if (!field.voids) given.valid.clear(), given.covers.clear();
    bytes = encode(given, distance);
    page = decoder.decode(id, extent, given.bands, distance, bytes);
  }
  GridRect extent;
  CodeDistance distance;
  Page given, page;
  PageDecoder decoder;
  std::vector<std::byte> bytes;
};

std::size_t expect_implied_as_defined(const Field& field, const Packed& packed) {
  Definition definition(field);
  std::size_t implied = 0;
  const Page& page = packed.page;
  for (std::int32_t row = 0; row < page.grid.rows; ++row) {
    for (std::int32_t col = 0; col < page.grid.cols; ++col) {
      const GridPoint p = page.grid.at(col, row);
      const std::size_t i = page.index(col, row);
      if (page.is_own(p)) {
        EXPECT_EQ(page.error(i, packed.distance), packed.given.errors[i]) << name_of(p);
      }
      if (!page.has_distance(i)) continue;
      ++implied;
      EXPECT_TRUE(page.is_own(p));
      EXPECT_EQ(page.distance_of(i), definition(p)) << name_of(p);
      if (testing::Test::HasFailure()) return implied;
    }
  }
  return implied;
}

TEST(PageErrors, OfWholeNumbersAreTheDefinitionsWithoutRounding) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const bool wide : {false, true}) {  // more than 16 bits hold
      const Field field(whole(fractal(150, 140, seed, wide ? 200000 : 100)));
      const Packed packed(field, {0, 0, 0});
      EXPECT_EQ(packed.page.is_dense, !wide);
      EXPECT_EQ(packed.page.eighths.empty(), !wide);
      EXPECT_GT(expect_implied_as_defined(field, packed), 15000u) << "of 16128 own vertices";
      const Packed narrow(field, {0, 1, 0});
      EXPECT_GT(expect_implied_as_defined(field, narrow), 1000u);
    }
  }
}

TEST(PageErrors, OfExtremeWholeNumbersDoNotOverflow) {
  const Field field(checkerboard(128, 128, -8388607, 8388607));
  const Packed packed(field, {0, 0, 0});
  EXPECT_FALSE(packed.page.eighths.empty());
  EXPECT_GT(expect_implied_as_defined(field, packed), 15000u);
  Random random(4);
  const Field noisy(whole(noise(128, 128, 4, -8e6, 8e6)));
  EXPECT_GT(expect_implied_as_defined(noisy, Packed(noisy, {0, 0, 0})), 15000u);
}

TEST(PageErrors, StandWhereverThePageStands) {
  for (const GridPoint first : {GridPoint{-40, -100}, {1000, -128}, {77, 3}}) {
    const Field field(whole(fractal(100, 110, 9)), first);
    for (const PageId id : pages_of_band(0, field.extent)) expect_implied_as_defined(field, Packed(field, id));
  }
}

TEST(PageErrors, OfFloatsAreTheDefinitionsToo) {
  const Field decimals(rounded(fractal(128, 128, 5), 100));
  const Packed exact(decimals, {0, 0, 0});
  EXPECT_FALSE(exact.page.distances.empty());
  EXPECT_GT(expect_implied_as_defined(decimals, exact), 15000u);
}

/// Whole numbers of 53 bits: a sum of two needs one more than a double has, and all is known exactly in 64.
TEST(PageErrors, WhereArithmeticRoundsAreNotBelowTheTruth) {
  Random random(9);
  std::vector<double> square(kSquare);
  for (double& v : square) v = static_cast<double>(static_cast<std::int64_t>(random.next() >> 11)) - 0x1p52;
  std::vector<double> distances(kSquare);
  implied_errors_rounded_up(square, PresentRect{}, {}, distances);
  const auto at = [&](int col, int row) { return static_cast<std::size_t>(row * kPageSide + col); };
  std::size_t sides = 0, centres = 0;
  for (int row = 1; row + 1 < kPageSide; ++row) {
    for (int col = 1; col + 1 < kPageSide; ++col) {
      const GridPoint p{col, row};
      if (spacing(p) != 1) continue;
      const Diamond d = diamond(p);
      const auto height = [&](GridPoint q) { return static_cast<std::int64_t>(square[at(q.col, q.row)]); };
      const std::int64_t twice = std::abs(2 * height(p) - height(d.ends[0]) - height(d.ends[1]));
      EXPECT_GE(static_cast<std::int64_t>(std::floor(2 * distances[at(col, row)])), twice) << col << ", " << row;
      ++(is_centre(p) ? centres : sides);
      if (!is_centre(p)) {  // and as near to it as two steps of a double
        EXPECT_LE(2 * distances[at(col, row)], static_cast<double>(twice) * (1 + 0x1p-50));
      }
    }
  }
  EXPECT_EQ(centres, 63u * 63u);
  EXPECT_EQ(sides, 2u * 63u * 63u);
}

TEST(PageErrors, AreImpliedAmidVoidsWhereEverythingInReachIsData) {
  for (const bool scattered : {false, true}) {
    for (const bool wide : {false, true}) {
      const Terrain ground = whole(fractal(140, 130, 6, wide ? 200000 : 100));
      const Field field(scattered ? random_voids(ground, 0.01, 6) : void_blobs(ground, 4, 6));
      const Packed packed(field, {0, 0, 0});
      EXPECT_EQ(packed.page.eighths.empty(), !wide);
      EXPECT_GT(expect_implied_as_defined(field, packed), scattered ? 6000u : 4000u);
    }
  }
}

TEST(PageErrors, DependOnSamplesWithinReachOnly) {
  // The samples that the definition looks at, collected: how far do they go?
  const std::map<std::pair<int, bool>, int> expected{
      {{1, true}, 1}, {{2, false}, 2}, {{2, true}, 4}, {{4, false}, 6}, {{4, true}, 10}};
  for (std::int32_t col = 64; col < 80; ++col) {
    for (std::int32_t row = 64; row < 80; ++row) {
      const GridPoint vertex{col, row};
      const int s = spacing(vertex);
      if (s > 4 || (s == 1 && !is_centre(vertex))) continue;
      int reach = 0;
      const auto look = [&](auto&& self, GridPoint p) -> void {
        const Diamond d = diamond(p);
        const bool finest_side = spacing(p) == 1 && !is_centre(p);
        for (const GridPoint q : {d.ends[0], d.ends[1], d.apexes[0], d.apexes[1]}) {
          if (finest_side && (q == d.apexes[0] || q == d.apexes[1])) continue;
          reach = std::max({reach, std::abs(q.col - col), std::abs(q.row - row)});
        }
        const Children below = children(p);
        for (int k = 0; k < below.count; ++k) self(self, below.at[static_cast<std::size_t>(k)]);
      };
      look(look, vertex);
      EXPECT_EQ(reach, expected.at({s, is_centre(vertex)})) << name_of(vertex);
      EXPECT_TRUE(is_implied_by_place(col, row, {col - reach, col + reach + 1, row - reach, row + reach + 1}));
      EXPECT_FALSE(is_implied_by_place(col, row, {col - reach + 1, 128, 0, 128}));
      EXPECT_FALSE(is_implied_by_place(col, row, {0, 128, 0, row + reach}));
    }
  }
}

TEST(PageErrors, OneThresholdSelectsASetClosedUnderParentsAcrossImpliedAndStored) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Terrain terrain = fractal(128, 128, seed, 60);
    if (seed % 2 == 0) terrain = void_blobs(terrain, 3, seed);
    const Field field(seed < 3 ? whole(terrain) : rounded(terrain, 10), {0, 0}, {1, 10, 0, true});
    const Packed packed(field, {0, 0, 0}, field.input.field.distance);
    const Page& page = packed.page;
    Random random(seed);
    for (int attempt = 0; attempt < 30; ++attempt) {
      const double tolerance = attempt == 0 ? 0 : random.log_between(0.01, 10);
      const auto is_selected = [&](std::size_t i) { return page.error_m(i, packed.distance) > tolerance; };
      for (std::int32_t row = 0; row < 128; ++row) {
        for (std::int32_t col = 0; col < 128; ++col) {
          const GridPoint p{col, row};
          if (!page.is_own(p) || !is_selected(page.index(col, row))) continue;
          for (const GridPoint parent : diamond(p).apexes) {
            if (!page.is_own(parent) || !GridRect{{0, 0}, {127, 127}}.contains(parent)) continue;
            ASSERT_TRUE(is_selected(page.index(parent.col, parent.row))) << name_of(p) << " at " << tolerance;
          }
        }
      }
    }
  }
}

TEST(PageErrors, ThatDifferFromTheHeightsOwnAreStored) {
  const Field field(whole(fractal(128, 128, 7)));
  Packed packed(field, {0, 0, 0});
  Page other = packed.given;
  other.errors[other.index(65, 66)] = static_cast<ErrorCode>(other.errors[other.index(65, 66)] + 1);
  const Page& back =
      packed.decoder.decode({0, 0, 0}, packed.extent, other.bands, packed.distance, encode(other, packed.distance));
  for (std::size_t i = 0; i < other.errors.size(); ++i) ASSERT_EQ(back.error(i, packed.distance), other.errors[i]);
}

}  // namespace
}  // namespace talus::support
