// Danger: errors that all lie exactly on tolerances people ask for: on a paraboloid a midpoint of spacing s is off by
// s², a centre by 2s². Whoever selects what reaches the tolerance, not what exceeds it, takes a level too many.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

double height(int col, int row) { return (col - 550.0) * (col - 550) + (row - 70.0) * (row - 70); }

bool naive_selects(double error, double tolerance) { return error >= tolerance; }

HardCase hard_case() {
  HardCase hard{.terrain = surface(1100, 140, height)};
  hard.file.type = SampleType::int32;
  hard.tolerances = {1, 2, 4, 8, 16, 1024, 262144};
  return hard;
}

TEST(QuadraticSurface, TiesWithRoundTolerances) {
  const double error = std::abs(height(66, 64) - (height(64, 64) + height(68, 64)) / 2);
  EXPECT_EQ(error, 4);
  EXPECT_TRUE(naive_selects(error, 4)) << "although the surface without it keeps the tolerance";
}

TEST(QuadraticSurface, KeepsThePromiseWithNoVertexTooMany) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const auto vertices = [&](double tolerance) { return database.judged(tolerance).points.size(); };
  // No error lies between 4 and 8: spacing 2 has midpoints at 4 and centres at 8.
  EXPECT_EQ(vertices(4), vertices(std::nextafter(8.0, 0.0)));
  EXPECT_GT(vertices(std::nextafter(4.0, 0.0)), vertices(4) * 3 / 2);
}

}  // namespace
}  // namespace talus::support
