// Danger: zeros of both signs. They are equal, so nothing that compares numbers sees that code · scale + offset, or
// prediction + residual, gave the source's -0 back as +0.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

double naive_value(double code) { return code * 1.0 + 0.0; }

HardCase hard_case(SampleType type, double else_where) {
  HardCase hard{.terrain = surface(150, 140, [&](int col, int row) {
                  if (row > 70 && col > 70) return else_where * ((col + row) % 3);
                  return (col / 3 + row) % 2 == 0 ? 0.0 : -0.0;
                })};
  hard.terrain = fit(hard.terrain, type);
  hard.file.type = type;
  hard.tolerances = {0.05, 1, 2};
  return hard;
}

TEST(SignedZero, LosesItsSignInArithmetic) {
  EXPECT_TRUE(std::signbit(-0.0));
  EXPECT_FALSE(std::signbit(naive_value(-0.0)));
}

TEST(SignedZero, AmongWholeNumbersKeepsThePromise) {
  HardDatabase(hard_case(SampleType::float32, 1)).hold_to_the_promise();
  HardDatabase(hard_case(SampleType::float64, 1)).hold_to_the_promise();
}

TEST(SignedZero, AmongDecimalsKeepsThePromise) {
  HardDatabase(hard_case(SampleType::float32, 0.1)).hold_to_the_promise();
  HardDatabase(hard_case(SampleType::float64, 0.1)).hold_to_the_promise();
}

TEST(SignedZero, AloneKeepsThePromise) {
  const HardDatabase database(hard_case(SampleType::float32, 0));
  database.hold_to_the_promise();
  EXPECT_EQ(database.judged(0).points.size(), database.judged(1).points.size()) << "zeros differ in sign only";
}

}  // namespace
}  // namespace talus::support
