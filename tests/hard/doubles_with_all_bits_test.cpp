// Danger: doubles that need every bit they have. The sum of two neighbours rounds to a number whose half is the
// sample between them, so an error that is not zero looks like none.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

const double kOne = 1, kNext = std::nextafter(1.0, 2.0);

double naive_error(double end, double midpoint, double other_end) { return std::abs(midpoint - (end + other_end) / 2); }

/// Noise in all 53 bits, a quiet place amid it, and there two neighbouring numbers.
HardCase hard_case() {
  HardCase hard{.terrain = noise(150, 140, 7, -1000, 9000)};
  for (int row = 60; row <= 68; ++row) {
    for (int col = 60; col <= 68; ++col) hard.terrain.at(col, row) = kOne;
  }
  hard.terrain.at(64, 64) = kNext;
  hard.file.type = SampleType::float64;
  hard.tolerances = {1e-16, 1e-9, 0.1, 100};
  return hard;
}

TEST(DoublesWithAllBits, HideAnErrorInASum) {
  EXPECT_EQ(naive_error(kOne, kOne, kNext), 0);
  const long double exact = (static_cast<long double>(kOne) + static_cast<long double>(kNext)) / 2 - 1;
  EXPECT_GT(exact, 0);
}

TEST(DoublesWithAllBits, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const Mesh mesh = database.judged(0);
  for (const GridPoint p : {GridPoint{63, 64}, {65, 64}, {64, 63}, {64, 65}}) EXPECT_TRUE(has_point(mesh, p));
}

}  // namespace
}  // namespace talus::support
