// Danger: heights that are the smallest numbers there are. Half of one is rounded to zero, so an error that is not
// zero looks like none, and a sample that tolerance 0 must restore is left out.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

double naive_error(double end, double midpoint, double other_end) { return std::abs(midpoint - (end + other_end) / 2); }

/// Zero, but for one smallest number on a corner of a block, and a field of them elsewhere.
HardCase hard_case(SampleType type, double smallest) {
  HardCase hard{.terrain = surface(
                    140, 90, [&](int col, int row) { return col > 80 ? smallest * ((col * 3 + row) % 5 - 2) : 0.0; })};
  hard.terrain.at(64, 64) = smallest;
  hard.file.type = type;
  hard.tolerances = {smallest, 3 * smallest, 1e-300, 1e-30};
  return hard;
}

void expect_all_around(const HardDatabase& database) {
  const Mesh mesh = database.judged(0);
  for (const GridPoint p : {GridPoint{63, 64}, {65, 64}, {64, 63}, {64, 65}}) {
    EXPECT_TRUE(has_point(mesh, p)) << p.col << ", " << p.row << " lies half of the smallest number off";
  }
}

TEST(Denormals, HaveHalvesThatAreRoundedAway) {
  const double smallest = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(naive_error(smallest, 0, 0), 0);
  const auto exact = std::abs(0 - static_cast<long double>(smallest) / 2);
  EXPECT_GT(exact, 0);
}

TEST(Denormals, InDoublesKeepThePromise) {
  const HardDatabase database(hard_case(SampleType::float64, std::numeric_limits<double>::denorm_min()));
  database.hold_to_the_promise();
  expect_all_around(database);
}

TEST(Denormals, InFloatsKeepThePromise) {
  const HardDatabase database(hard_case(SampleType::float32, double{std::numeric_limits<float>::denorm_min()}));
  database.hold_to_the_promise();
  expect_all_around(database);
}

}  // namespace
}  // namespace talus::support
