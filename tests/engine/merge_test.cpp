// Two sets of vertices that become one, against std::map; and increments that fit no answer.

#include "engine/quadtree/merge.hpp"

#include <bit>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/engine/random_answers.hpp"
#include "tests/support/quadtrees.hpp"

namespace talus::support {
namespace {

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

TEST(United, IsBothSetsWithTheirHeightsAndCovers) {
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridRect window = random_rect(random, 60);
    RestrictedQuadtree kept, added;
    std::map<Point, std::pair<double, std::uint8_t>> expected;
    std::vector<GridPoint> gone;
    const bool covers = random.chance(0.5);
    for (RestrictedQuadtree* q : {&kept, &added}) q->region = window, q->vertices = VertexMask(window);
    for_each_point(window, [&](GridPoint p) {
      if (random.chance(0.6)) return;
      (random.chance(0.5) ? kept : added).vertices.insert(p);
    });
    for (RestrictedQuadtree* q : {&kept, &added}) {
      q->vertices.seal();
      q->vertices.for_each([&](GridPoint p) {
        q->heights.push_back(random.within(0, 100));
        if (covers) q->covers.push_back(static_cast<std::uint8_t>(random.between(0, 15)));
        const std::uint8_t cover = covers ? q->covers.back() : std::uint8_t{15};
        if (q == &kept && random.chance(0.2)) {
          gone.push_back(p);
        } else {
          expected[key(p)] = {q->heights[q->heights.size() - 1], cover};
        }
      });
    }
    const RestrictedQuadtree both = united(kept, gone, added);
    ASSERT_EQ(both.vertices.size(), expected.size());
    std::size_t i = 0;
    both.vertices.for_each([&](GridPoint p) {
      const auto found = expected.find(key(p));
      ASSERT_NE(found, expected.end());
      EXPECT_TRUE(same_bits(both.heights[i], found->second.first));
      EXPECT_EQ(both.covers.empty() ? 15 : both.covers[i], found->second.second);
      ++i;
    });
    EXPECT_EQ(both.region, added.region);
    if (kept.vertices.size() > 0) {
      EXPECT_THROW(static_cast<void>(united(kept, {}, kept)), Failure) << "one set, twice";
    }
  }
}

/// A quadtree of some points, whose heights count from a number on.
RestrictedQuadtree quadtree(GridRect window, const std::vector<GridPoint>& points, double from) {
  RestrictedQuadtree q;
  q.region = window;
  q.vertices = VertexMask(window);
  for (const GridPoint p : points) q.vertices.insert(p);
  q.vertices.seal();
  for (std::size_t i = 0; i < points.size(); ++i) q.heights.push_back(from + static_cast<double>(i));
  return q;
}

TEST(United, KeepsOfTheFirstOnlyWhatLiesInTheRegionOfTheSecond) {
  const RestrictedQuadtree kept = quadtree({{0, 0}, {9, 9}}, {{0, 0}, {4, 4}, {6, 6}, {9, 9}}, 10);
  const RestrictedQuadtree added = quadtree({{4, 4}, {70, 7}}, {{5, 4}, {70, 7}}, 20);
  const RestrictedQuadtree both = united(kept, {}, added);
  EXPECT_EQ(both.vertices.region(), added.vertices.region());
  EXPECT_EQ(both.heights, (Array<double>{11, 20, 12, 21})) << "row by row";
  const std::vector<GridPoint> gone{{6, 6}, {0, 0}, {300, 300}};
  EXPECT_EQ(united(kept, gone, added).heights, (Array<double>{11, 20, 21})) << "those that are nowhere do no harm";
}

TEST(United, IsOtherwiseTheSecondAndWithoutCoversWhereAllTrianglesHoldData) {
  RestrictedQuadtree kept = quadtree({{0, 0}, {9, 9}}, {{0, 0}, {4, 4}}, 10);
  RestrictedQuadtree added = quadtree({{0, 0}, {9, 9}}, {{5, 4}}, 20);
  kept.tolerance = Metres{9}, kept.bound = Metres{8}, kept.level_errors = {1, 2};
  added.tolerance = Metres{5}, added.bound = Metres{4}, added.level_errors = {3, 4};
  added.origin.identity = {77, 2};
  RestrictedQuadtree both = united(kept, {}, added);
  EXPECT_EQ(both.tolerance, Metres{5});
  EXPECT_EQ(both.bound, Metres{4});
  EXPECT_EQ(both.level_errors, added.level_errors);
  EXPECT_EQ(both.origin, added.origin);
  EXPECT_TRUE(both.covers.empty());
  kept.covers = {15, 15};
  EXPECT_TRUE(united(kept, {}, added).covers.empty());
  kept.covers = {15, 3};
  EXPECT_EQ(united(kept, {}, added).covers, (std::vector<std::uint8_t>{15, 3, 15})) << "the others are whole";
}

TEST(United, RefusesMoreOrFewerHeightsOrCoversThanVertices) {
  const RestrictedQuadtree good = quadtree({{0, 0}, {9, 9}}, {{0, 0}, {4, 4}}, 10),
                           other = quadtree({{0, 0}, {9, 9}}, {{5, 4}}, 20);
  for (const bool first : {true, false}) {
    for (int defect = 0; defect < 3; ++defect) {
      RestrictedQuadtree bad = good;
      if (defect == 0) bad.heights.push_back(1);
      if (defect == 1) bad.heights.pop_back();
      if (defect == 2) bad.covers = {15};
      EXPECT_THROW(static_cast<void>(first ? united(bad, {}, other) : united(other, {}, bad)), Failure) << defect;
    }
  }
}

// ---- increments ------------------------------------------------------------------------------------------

RestrictedQuadtree answer() {
  RestrictedQuadtree q = quadtree({{0, 0}, {9, 9}}, {{0, 0}, {4, 4}}, 10);
  q.tolerance = Metres{9}, q.bound = Metres{9}, q.level_errors = {0, 4, 7};
  q.origin.identity = {77, 2};
  q.origin.is_plain = true;
  return q;
}
Increment increment() {
  Increment i;
  i.added = quadtree({{0, 0}, {9, 9}}, {{5, 4}}, 20);
  i.added.tolerance = Metres{5}, i.added.bound = Metres{5}, i.added.level_errors = {3, 5, 0};
  i.added.origin = answer().origin;
  i.from = Metres{9};
  return i;
}

TEST(Merge, TakesOverTheIncrementAndTheLargerErrorOfEachLevel) {
  const RestrictedQuadtree merged = merge(answer(), increment());
  EXPECT_EQ(merged.heights, (Array<double>{10, 11, 20}));
  EXPECT_EQ(merged.tolerance, Metres{5});
  EXPECT_EQ(merged.bound, Metres{5});
  EXPECT_EQ(merged.level_errors, (std::vector<double>{3, 5, 7}));
  EXPECT_EQ(merged.origin, answer().origin);
}

TEST(Merge, RefusesAnIncrementThatDoesNotGoOnFromTheAnswer) {
  struct Change {
    const char* word;  ///< in the sentence
    std::function<void(RestrictedQuadtree&, Increment&)> change;
  };
  const std::vector<Change> changes{
      {"no increment can follow", [](RestrictedQuadtree& a, Increment&) { a.origin.is_plain = false; }},
      {"another database", [](RestrictedQuadtree& a, Increment&) { a.origin.identity.content = 78; }},
      {"update", [](RestrictedQuadtree& a, Increment&) { a.origin.identity.generation = 3; }},
      {"database",
       [](RestrictedQuadtree& a, Increment& i) {
         a.origin.identity.content = 0;  // nobody knows which
         i.added.origin.identity.content = 0;
       }},
      {"region", [](RestrictedQuadtree& a, Increment&) { a.region.last.col = 8; }},
      {"region",
       [](RestrictedQuadtree& a, Increment&) {
         a.vertices = VertexMask({{0, 0}, {9, 10}});
         a.vertices.insert({0, 0}), a.vertices.insert({4, 4});
         a.vertices.seal();
       }},
      {"9", [](RestrictedQuadtree&, Increment& i) { i.from = Metres{8}; }},
      {"Heights::quantum", [](RestrictedQuadtree& a, Increment&) { a.origin.quantum = Metres{1}; }},
      {"levels", [](RestrictedQuadtree& a, Increment&) { a.level_errors.push_back(0); }},
      {"heights", [](RestrictedQuadtree& a, Increment&) { a.heights.push_back(0); }},
      {"already",
       [](RestrictedQuadtree&, Increment& i) {
         i.added.vertices = VertexMask({{0, 0}, {9, 9}});
         i.added.vertices.insert({4, 4});
         i.added.vertices.seal();
       }},
  };
  EXPECT_NO_THROW(static_cast<void>(merge(answer(), increment())));
  for (std::size_t c = 0; c < changes.size(); ++c) {
    SCOPED_TRACE(c);
    RestrictedQuadtree a = answer();
    Increment i = increment();
    changes[c].change(a, i);
    try {
      static_cast<void>(merge(a, i));
      ADD_FAILURE() << "was merged";
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.cause(), Cause::invalid_argument);
      EXPECT_THAT(failure.what(), ::testing::HasSubstr(changes[c].word));
    }
  }
}

}  // namespace
}  // namespace talus::support
