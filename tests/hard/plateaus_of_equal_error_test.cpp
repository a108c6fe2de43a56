// Danger: thousands of vertices whose error is one and the same, at a tolerance of exactly that. All of them may be
// left out; whoever turns the tolerance into a float first, or asks for >=, keeps them all.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kError = 0.7;

bool naive_selects(double error, double tolerance) {
  return error > static_cast<double>(static_cast<float>(tolerance));
}

/// Towers of one height on odd columns and even rows, no two beside each other.
HardCase hard_case() {
  HardCase hard{.terrain = plane(1100, 140, 0, 0, 0)};
  for (int row = 2; row < 139; row += 4) {
    for (int col = 1 + row % 8; col < 1099; col += 4) hard.terrain.at(col, row) = kError;
  }
  hard.file.type = SampleType::float64;
  hard.tolerances = {kError, std::nextafter(kError, 0.0), std::nextafter(kError, 1.0), 0.5};
  return hard;
}

TEST(PlateausOfEqualError, AllExceedTheirOwnErrorAsAFloat) {
  EXPECT_LT(static_cast<double>(static_cast<float>(kError)), kError);
  EXPECT_TRUE(naive_selects(kError, kError));
}

TEST(PlateausOfEqualError, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const auto vertices = [&](double tolerance) { return database.judged(tolerance).points.size(); };
  EXPECT_GT(vertices(std::nextafter(kError, 0.0)), vertices(1e9) * 4);
  EXPECT_EQ(vertices(0.71), vertices(1e9)) << "one rung above, no tower is needed";
}

}  // namespace
}  // namespace talus::support
