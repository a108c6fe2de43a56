// Danger: decimetre codes and a tolerance of three decimetres. Three times 0.1 is more than 0.3 in doubles, so every
// vertex with an error of exactly three codes looks as if it exceeded the tolerance.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

double naive_metres(int codes) { return codes * 0.1; }

HardCase hard_case() {
  HardCase hard{.terrain = plane(1100, 140, 0, 0, 0)};
  for (int row = 21; row < 120; row += 10) {
    for (int col = 21; col < 1090; col += 10) hard.terrain.at(col, row) = row % 20 == 1 ? 3 : -3;
  }
  hard.file.scale = 0.1;
  hard.tolerances = {0.1, 0.2, 0.3, std::nextafter(0.3, 0.0), std::nextafter(0.3, 1.0)};
  return hard;
}

TEST(ScaledTies, ExceedTheirToleranceWhenMultiplied) {
  EXPECT_GT(naive_metres(3), 0.3);
  EXPECT_EQ(3 / 10.0, 0.3);
}

TEST(ScaledTies, KeepThePromiseAndTie) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const auto vertices = [&](double tolerance) { return database.judged(tolerance).points.size(); };
  EXPECT_EQ(vertices(0.3), vertices(1e9));
  EXPECT_GT(vertices(std::nextafter(0.3, 0.0)), vertices(1e9));
}

}  // namespace
}  // namespace talus::support
