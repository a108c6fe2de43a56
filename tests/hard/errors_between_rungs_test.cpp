// Danger: errors that lie between the rungs on which errors are stored. Rounded to the nearest rung half of them
// become too small, and a tolerance just above that rung leaves out a vertex that it needs.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kError = 1012;

/// Three significant digits, as near as can be.
double naive_stored(double error) {
  const double unit = std::pow(10, std::floor(std::log10(error)) - 1) / 4;
  return std::round(error / unit) * unit;
}

HardCase hard_case() {
  HardCase hard{.terrain = plane(1100, 140, 0, 0, 0)};
  for (const int col : {32, 96, 160, 512, 992, 1024, 1056}) {  // centres and midpoints of stored errors
    hard.terrain.at(col, 64) = kError;
    hard.terrain.at(col, 32) = -kError;
  }
  hard.file.nodata = -32768;
  hard.tolerances = {1000, 1011, 1012, 1013, 1025, 2024};
  return hard;
}

TEST(ErrorsBetweenRungs, RoundDownToTheNearest) { EXPECT_EQ(naive_stored(kError), 1000); }

TEST(ErrorsBetweenRungs, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const Mesh mesh = database.judged(1000);
  for (const int col : {32, 96, 160, 512, 992, 1024, 1056}) {
    EXPECT_TRUE(has_point(mesh, {col, 64})) << col;
    EXPECT_TRUE(has_point(mesh, {col, 32})) << col;
  }
}

}  // namespace
}  // namespace talus::support
