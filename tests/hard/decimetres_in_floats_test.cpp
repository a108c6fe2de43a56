// Danger: decimetres stored as 32-bit floats, and a tolerance of so many decimetres. In decimetres an error of three
// equals the tolerance; between the floats that are handed out it is 12 nanometres more.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

double naive_error_m(float spike, float ground) { return std::round(static_cast<double>(spike - ground) * 10) / 10; }

/// Flat ground at zero with spikes of 0.3 m, apart from each other and from all borders of blocks.
HardCase hard_case() {
  HardCase hard{.terrain = plane(1100, 140, 0, 0, 0)};
  for (int row = 21; row < 120; row += 10) {
    for (int col = 21; col < 1090; col += 10) hard.terrain.at(col, row) = double{0.3F};
  }
  hard.file.type = SampleType::float32;
  hard.tolerances = {0.1, 0.3, std::nextafter(0.3, 1.0), double{0.3F}, 0.31};
  return hard;
}

TEST(DecimetresInFloats, TieWhereTheFloatsDoNot) {
  EXPECT_EQ(naive_error_m(0.3F, 0), 0.3);
  EXPECT_GT(double{0.3F}, 0.3);
}

TEST(DecimetresInFloats, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  EXPECT_TRUE(has_point(database.judged(0.3), {1021, 61})) << "it lies 0.300000012 m off";
  EXPECT_EQ(database.judged(0.31).points.size(), database.judged(1000).points.size());
}

}  // namespace
}  // namespace talus::support
