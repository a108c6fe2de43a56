// Danger: a plane of decimals. In decimals it is exact; the doubles that stand for them lie off it by some last
// digits, and whoever computes errors in decimals says zero where it is not.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr int kEast = 1, kSouth = 3;  // tenths

int tenths(int col, int row) { return 1000 + kEast * col + kSouth * row; }

double naive_error(int end, int midpoint, int other_end) { return std::abs(2 * midpoint - end - other_end) / 20.0; }

HardCase hard_case(SampleType type) {
  HardCase hard{.terrain = fit(surface(1100, 140, [](int col, int row) { return tenths(col, row) / 10.0; }), type)};
  hard.file.type = type;
  hard.tolerances = {1e-15, 1e-12, 1e-9, 1e-6, 1e-4};
  return hard;
}

TEST(DecimalPlane, IsNoPlaneInDoubles) {
  const auto exact = [](int col) {
    const auto at = [](int c) { return static_cast<long double>(tenths(c, 64) / 10.0); };
    return std::abs(at(col) - (at(col - 1) + at(col + 1)) / 2);
  };
  int hidden = 0;
  for (int col = 1; col < 1099; col += 2) {
    hidden += naive_error(tenths(col - 1, 64), tenths(col, 64), tenths(col + 1, 64)) == 0 && exact(col) > 0;
  }
  EXPECT_GT(hidden, 0);
}

TEST(DecimalPlane, InDoublesKeepsThePromise) {
  const HardDatabase database(hard_case(SampleType::float64));
  database.hold_to_the_promise();
  // The first rung of stored errors is 2.5 micrometres: below it rounding counts.
  EXPECT_EQ(database.judged(2.5e-6).points.size(), database.judged(1e9).points.size());
}

TEST(DecimalPlane, InFloatsKeepsThePromise) {
  const HardDatabase database(hard_case(SampleType::float32));
  database.hold_to_the_promise();
  EXPECT_EQ(database.judged(0.001).points.size(), database.judged(1e9).points.size());
}

}  // namespace
}  // namespace talus::support
