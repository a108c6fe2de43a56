// An answer taken apart level by level, against loops over its vertices.

#include "talus/progression.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/engine/random_answers.hpp"
#include "tests/support/quadtrees.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An answer with a bound, and with errors of its levels or without.
RestrictedQuadtree random_levels(Random& random) {
  const GridRect window = random_rect(random, 60);
  RestrictedQuadtree answer = random_answer(random, window, 60);
  answer.tolerance = Metres{5}, answer.bound = Metres{4};
  answer.origin.is_plain = true;
  if (random.chance(0.7)) {
    for (std::int32_t side = 1; side <= root_side(window); side *= 2)
      answer.level_errors.push_back(random.within(0, 9));
  }
  return answer;
}

/// The step of each vertex as the header says it.
std::map<Point, std::size_t> steps_of(const RestrictedQuadtree& answer, std::size_t root) {
  std::set<Point> forced;
  for (const GridPoint p : border_vertices(answer.vertices.region(), std::int32_t{1} << root)) forced.insert(key(p));
  std::map<Point, std::size_t> steps;
  answer.vertices.for_each([&](GridPoint p) {
    std::size_t step = 1;
    while (step <= root && spacing(p) < std::int32_t{1} << (root - step)) ++step;
    const bool is_root_corner = spacing(p) >= std::int32_t{1} << root;
    steps[key(p)] = forced.contains(key(p)) || is_root_corner ? 0 : step;
  });
  return steps;
}
std::size_t root_of(const RestrictedQuadtree& answer) {
  std::size_t root = 0;
  while (std::int32_t{1} << root < root_side(answer.vertices.region())) ++root;
  return root;
}

TEST(Progression, HoldsEachVertexOnceInTheStepOfItsLevelRowByRow) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const RestrictedQuadtree answer = random_levels(random);
    const std::size_t root = root_of(answer);
    const auto expected = steps_of(answer, root);
    const Progression levels(answer);
    ASSERT_EQ(levels.steps(), root + 1);
    std::size_t found = 0;
    for (std::size_t step = 0; step < levels.steps(); ++step) {
      EXPECT_EQ(levels.shift(step), static_cast<int>(root - step));
      const auto points = levels.points(step);
      const auto ranks = levels.ranks(step);
      ASSERT_EQ(points.size(), ranks.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_TRUE(answer.vertices.contains(points[i]));
        EXPECT_EQ(ranks[i], answer.vertices.rank(points[i]));
        EXPECT_EQ(expected.at(key(points[i])), step) << name_of(points[i]);
      }
      EXPECT_TRUE(std::is_sorted(ranks.begin(), ranks.end()));
      found += points.size();
    }
    EXPECT_EQ(found, answer.vertices.size());
  }
}

TEST(Progression, ByErrorsHasTheLargestFirstAndOfEqualOnesCentresFirst) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const RestrictedQuadtree answer = random_levels(random);
    std::vector<double> errors;
    for (std::size_t i = 0; i < answer.vertices.size(); ++i) errors.push_back(random.between(0, 4));
    const Progression plain(answer), ordered(answer, errors);
    for (std::size_t step = 0; step < plain.steps(); ++step) {
      std::vector<std::uint32_t> expected(plain.ranks(step).begin(), plain.ranks(step).end());
      std::vector<GridPoint> points(answer.vertices.size());
      answer.vertices.for_each([&](GridPoint p) { points[answer.vertices.rank(p)] = p; });
      std::sort(expected.begin(), expected.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (errors[a] != errors[b]) return errors[a] > errors[b];
        if (is_centre(points[a]) != is_centre(points[b])) return is_centre(points[a]);
        return a < b;
      });
      EXPECT_TRUE(std::ranges::equal(ordered.ranks(step), expected));
      for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(ordered.points(step)[i], points[expected[i]]);
    }
  }
}

TEST(Progression, TheBoundOfAStepIsTheLargestErrorOfTheFinerLevels) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const RestrictedQuadtree answer = random_levels(random);
    const Progression levels(answer);
    for (std::size_t step = 0; step < levels.steps(); ++step) {
      double expected = answer.bound.value;
      for (std::size_t shift = 0; shift < static_cast<std::size_t>(levels.shift(step)); ++shift)
        expected = std::max(expected, answer.level_errors.empty() ? kInfinity : answer.level_errors[shift]);
      EXPECT_EQ(levels.bound(step).value, expected) << step;
    }
  }
}

TEST(Progression, APrefixHasTheFirstVerticesWithTheirHeightsAndCovers) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const RestrictedQuadtree answer = random_levels(random);
    const Progression levels(answer);
    for (std::size_t steps = 1; steps <= levels.steps(); ++steps) {
      const std::size_t next = steps < levels.steps() ? levels.points(steps).size() : 0;
      const auto more = static_cast<std::size_t>(random.chance(0.5) ? 0 : random.between(0, static_cast<int>(next)));
      std::vector<GridPoint> points;
      for (std::size_t step = 0; step < steps; ++step)
        points.insert(points.end(), levels.points(step).begin(), levels.points(step).end());
      for (std::size_t i = 0; i < more; ++i) points.push_back(levels.points(steps)[i]);
      std::sort(points.begin(), points.end(),
                [](GridPoint a, GridPoint b) { return a.row != b.row ? a.row < b.row : a.col < b.col; });
      RestrictedQuadtree expected;
      expected.region = answer.region;
      expected.tolerance = answer.tolerance;
      expected.origin = answer.origin;
      const bool is_all = points.size() == answer.vertices.size();
      expected.origin.is_plain = is_all;
      expected.bound = is_all ? answer.bound : levels.bound(steps - 1);
      expected.level_errors = answer.level_errors;
      if (more == 0 && !answer.level_errors.empty()) {
        for (std::size_t step = steps; step < levels.steps(); ++step)
          expected.level_errors[static_cast<std::size_t>(levels.shift(step))] = 0;
      }
      expected.vertices = VertexMask(answer.vertices.region());
      for (const GridPoint p : points) {
        expected.vertices.insert(p);
        expected.heights.push_back(answer.heights[answer.vertices.rank(p)]);
        if (!answer.covers.empty()) expected.covers.push_back(answer.covers[answer.vertices.rank(p)]);
      }
      expected.vertices.seal();
      EXPECT_EQ(difference(levels.prefix(answer, steps, more), expected), "") << steps << " steps and " << more;
    }
    EXPECT_EQ(difference(levels.prefix(answer, levels.steps()), answer), "");
  }
}

TEST(Progression, RefusesWhatHasNoCoarserAnswersInIt) {
  Random random(3);
  const RestrictedQuadtree answer = random_levels(random);
  const auto is_refused = [](const std::function<void()>& work) {
    try {
      work();
      return false;
    } catch (const Failure& failure) {
      return failure.cause() == Cause::invalid_argument;
    }
  };
  for (const Border border : {Border::cover, Border::clip}) {
    RestrictedQuadtree other = answer;
    other.origin.border = border;
    EXPECT_TRUE(is_refused([&] { static_cast<void>(Progression(other)); }));
  }
  EXPECT_TRUE(
      is_refused([&] { static_cast<void>(Progression(answer, std::vector<double>(answer.vertices.size() + 1))); }));
  EXPECT_FALSE(
      is_refused([&] { static_cast<void>(Progression(answer, std::vector<double>(answer.vertices.size()))); }));
  const Progression levels(answer);
  const std::size_t steps = levels.steps();
  EXPECT_TRUE(is_refused([&] { static_cast<void>(levels.prefix(answer, 0)); }));
  EXPECT_TRUE(is_refused([&] { static_cast<void>(levels.prefix(answer, steps + 1)); }));
  EXPECT_TRUE(is_refused([&] { static_cast<void>(levels.prefix(answer, steps, 1)); }));
  EXPECT_TRUE(
      is_refused([&] { static_cast<void>(levels.prefix(answer, steps - 1, levels.points(steps - 1).size() + 1)); }));
  RestrictedQuadtree another = answer;
  another.heights.push_back(0);
  EXPECT_TRUE(is_refused([&] { static_cast<void>(levels.prefix(another, 1)); }));
}

}  // namespace
}  // namespace talus::support
