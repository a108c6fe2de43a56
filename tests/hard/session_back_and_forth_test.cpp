// Danger: a client that goes back and forth between tolerances and rectangles two hundred times. Whoever only adds to
// what it has ends with more than it asked for, which is no answer: its mesh covers what lies outside, or cracks there.

#include <gtest/gtest.h>

#include "talus/session.hpp"
#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"
#include "tests/support/quadtrees.hpp"

namespace talus::support {
namespace {

struct Step {
  GridRect region;
  double tolerance;
};

Step step(int i) {
  const double tolerances[] = {40, 0, 1e9, 3, 3, 0.5};
  const int west = i * 7 % 60, north = i * 5 % 40;
  const bool stays = i % 3 == 2;  // a tolerance that changes in one rectangle
  return stays ? Step{step(i - 1).region, tolerances[i % 6]}
               : Step{{{west, north}, {west + 64 + i % 5, north + 41}}, tolerances[i % 6]};
}

HardCase hard_case() {
  HardCase hard{.terrain = void_blobs(fit(fractal(140, 90, 8, 600), SampleType::int16), 3, 6)};
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  return hard;
}

std::size_t naive_count(const Snapshot& now, int steps, GridRect within) {
  VertexMask has(now.description().extent);
  for (int i = 0; i <= steps; ++i) {
    now.ask({.region = step(i).region, .tolerance = Metres{step(i).tolerance}})
        .quadtree.vertices.for_each([&](GridPoint p) {
          if (within.contains(p)) has.insert(p);
        });
  }
  has.seal();
  return has.size();
}

TEST(SessionBackAndForth, EndsWithTooMuchIfNothingIsDropped) {
  const HardDatabase database(hard_case());
  const int last = 44;  // in the rectangle of step 43, at 1e9 m
  const Step s = step(last);
  ASSERT_EQ(s.tolerance, 1e9);
  const auto answer = database.now().ask({.region = s.region, .tolerance = Metres{s.tolerance}}).quadtree;
  EXPECT_GT(naive_count(database.now(), last, s.region), 2 * answer.vertices.size());
}

TEST(SessionBackAndForth, KeepsThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const Snapshot& now = database.now();
  Session session(std::uint64_t{1} << 20);
  RestrictedQuadtree client;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Step s = step(i);
    client = without_float_exceptions([&] { return apply(client, session.next(now, s.region, Metres{s.tolerance})); });
    const auto answer = now.ask({.region = s.region, .tolerance = Metres{s.tolerance}}).quadtree;
    ASSERT_EQ(difference(client, answer), "");
    if (i % 20 != 0) continue;
    const OracleReport report = check_mesh(triangulate(client), database.truth(), 1, s.tolerance);
    ASSERT_TRUE(report.sound()) << report.summary();
  }
}

}  // namespace
}  // namespace talus::support
