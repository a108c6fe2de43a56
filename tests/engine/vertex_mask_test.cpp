// Sets of vertices and their ranks, against std::set and against one bool a sample.

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "talus/quadtree.hpp"
#include "tests/engine/fields.hpp"
#include "tests/support/failure_of.hpp"

namespace talus::support {
namespace {

TEST(VertexMask, AgreesWithASetOfPoints) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridPoint first{random.between(-1000, 1000), random.between(-1000, 1000)};
    // 63, 64 and 65 columns end before, on and after a word.
    const GridRect region{
        first, {first.col + random.between(0, 1) * 64 + random.between(0, 66), first.row + random.between(0, 40)}};
    const double density = random.unit();
    VertexMask mask(region);
    std::set<std::pair<int, int>> expected;  // row by row
    for_each_point(region, [&](GridPoint p) {
      if (!random.chance(density)) return;
      mask.insert(p);
      mask.insert(p);  // twice is once
      expected.insert({p.row, p.col});
    });
    mask.seal();
    EXPECT_EQ(mask.size(), expected.size());
    EXPECT_EQ(mask.region(), region);

    std::vector<GridPoint> points;
    for_each_point(region, [&](GridPoint p) { points.push_back(p); });
    std::vector<std::uint32_t> ranks(points.size());
    mask.ranks(points, ranks);
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const GridPoint p = points[i];
      const bool in = expected.contains({p.row, p.col});
      ASSERT_EQ(mask.contains(p), in) << name_of(p);
      ASSERT_EQ(mask.rank(p), before) << name_of(p);
      ASSERT_EQ(ranks[i], before) << name_of(p);
      before += in ? 1 : 0;
    }

    auto next = expected.begin();
    mask.for_each([&](GridPoint p) {
      ASSERT_NE(next, expected.end());
      EXPECT_EQ((std::pair{p.row, p.col}), *next++);
    });
    EXPECT_EQ(next, expected.end());
  }
}

TEST(VertexMask, SealsAgainAfterMoreWasInserted) {
  VertexMask mask({{0, 0}, {99, 9}});
  mask.insert({70, 3});
  mask.seal();
  EXPECT_EQ(mask.rank({71, 3}), 1u);
  mask.insert({2, 0});
  mask.seal();
  EXPECT_EQ(mask.size(), 2u);
  EXPECT_EQ(mask.rank({70, 3}), 1u);
}

TEST(VertexMask, AnEmptyOneHasNoMembers) {
  VertexMask none, mask({{5, 5}, {80, 6}});
  none.seal();
  mask.seal();
  EXPECT_EQ(none.size(), 0u);
  EXPECT_EQ(mask.size(), 0u);
  mask.for_each([](GridPoint) { FAIL(); });
}

TEST(VertexMask, TakesASetOfTheSameRegionOnly) {
  VertexMask mask({{0, 0}, {9, 9}});
  EXPECT_EQ(failure_of([&] { mask.insert(VertexMask({{0, 0}, {9, 10}})); })->cause(), Cause::invalid_argument);
}

/// A mask and a vector of bools side by side.
struct Both {
  explicit Both(GridRect r)
      : region(r), mask(r), plain(static_cast<std::size_t>(r.samples())), cols(static_cast<std::size_t>(r.cols())) {}
  [[nodiscard]] std::size_t at(GridPoint p) const {
    return static_cast<std::size_t>(p.row - region.first.row) * cols +
           static_cast<std::size_t>(p.col - region.first.col);
  }
  void insert(GridPoint p) {
    mask.insert(p);
    plain[at(p)] = true;
  }
  void expect_same() {
    mask.seal();
    ASSERT_EQ(mask.size(), static_cast<std::size_t>(std::count(plain.begin(), plain.end(), true)));
    std::vector<GridPoint> members, visited;
    for_each_point(region, [&](GridPoint p) {
      ASSERT_EQ(mask.contains(p), plain[at(p)]) << name_of(p);
      ASSERT_EQ(mask.rank(p), members.size()) << name_of(p);
      if (plain[at(p)]) members.push_back(p);
    });
    mask.for_each([&](GridPoint p) { visited.push_back(p); });
    EXPECT_EQ(visited, members);
  }
  GridRect region;
  VertexMask mask;
  std::vector<bool> plain;
  std::size_t cols;
};

TEST(VertexMask, IsAVectorOfBoolsWhateverIsDoneToIt) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridPoint first{random.between(-500, 500), random.between(-500, 500)};
    const GridRect region{first, {first.col + random.between(0, 200), first.row + random.between(0, 30)}};
    const auto any_row = [&] { return random.between(region.first.row, region.last.row); };
    const auto any_point = [&] { return GridPoint{random.between(region.first.col, region.last.col), any_row()}; };
    Both both(region);
    for (int operations = 12; operations > 0; --operations) {
      switch (random.between(0, 5)) {
        case 5: {  // another set
          Both other(region);
          for (int i = 0; i < 50; ++i) other.insert(any_point());
          both.mask.insert(other.mask);
          for (std::size_t i = 0; i < both.plain.size(); ++i) both.plain[i] = both.plain[i] || other.plain[i];
          break;
        }
        case 0:
          for (int i = 0; i < 50; ++i) both.insert(any_point());
          break;
        case 1: {  // a row's words, each bit set or not
          const std::int32_t row = any_row();
          const auto words = both.mask.row_words(row);
          ASSERT_EQ(words.size(), (both.cols + 63) / 64);
          for (std::size_t i = 0; i < both.cols; ++i) {
            const bool in = random.chance(0.5);
            const std::uint64_t bit = std::uint64_t{1} << (i % 64);
            words[i / 64] = in ? words[i / 64] | bit : words[i / 64] & ~bit;
            both.plain[both.at({region.first.col + static_cast<std::int32_t>(i), row})] = in;
          }
          break;
        }
        case 2: {  // those of some rows, read as words and as points
          both.mask.seal();
          const std::int32_t from = any_row(), to = random.between(from - 1, region.last.row);
          std::vector<GridPoint> expected, visited;
          if (from <= to) {
            for_each_point({{region.first.col, from}, {region.last.col, to}}, [&](GridPoint p) {
              const auto i = static_cast<std::size_t>(p.col - region.first.col);
              const auto words = std::as_const(both.mask).row_words(p.row);
              ASSERT_EQ((words[i / 64] >> (i % 64) & 1u) != 0, both.plain[both.at(p)]);
              if (both.plain[both.at(p)]) expected.push_back(p);
            });
          }
          both.mask.for_each_in_rows(from, to, [&](GridPoint p) { visited.push_back(p); });
          EXPECT_EQ(visited, expected);
          break;
        }
        case 3: {  // many ranks at once
          both.mask.seal();
          std::vector<GridPoint> points;
          for (int i = 0; i < 40; ++i) points.push_back(any_point());
          std::vector<std::uint32_t> ranks(points.size());
          both.mask.ranks(points, ranks);
          for (std::size_t i = 0; i < points.size(); ++i) {
            const auto end = both.plain.begin() + static_cast<std::ptrdiff_t>(both.at(points[i]));
            ASSERT_EQ(ranks[i], std::count(both.plain.begin(), end, true)) << name_of(points[i]);
          }
          break;
        }
        default: {  // a copy lives on its own
          Both copy = both;
          copy.insert(any_point());
          copy.expect_same();
          break;
        }
      }
      both.expect_same();
      if (HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace talus::support
