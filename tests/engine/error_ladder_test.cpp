// Stored errors: what a code stands for, and that nothing is rounded down.

#include "engine/error/error_ladder.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void expect_smallest_not_below(double metres) {
  const ErrorCode code = error_code(metres);
  EXPECT_GE(error_of(code), metres);
  if (code > 0) {
    EXPECT_LT(error_of(static_cast<ErrorCode>(code - 1)), metres) << "code " << code << " for " << metres;
  }
}

TEST(ErrorLadder, RoundValuesAreOnIt) {
  for (const double metres : {0.0, 0.001, 0.01, 0.025, 0.1,  0.2,  0.25, 0.3,   0.5,   0.75,   1.0,    1.25, 1.5,
                              2.0, 2.5,   5.0,  10.0,  20.0, 25.0, 50.0, 100.0, 250.0, 1000.0, 8000.0, 1e6,  1e7}) {
    EXPECT_EQ(error_of(error_code(metres)), metres);
  }
  for (int tenths = 1; tenths <= 100; ++tenths) EXPECT_EQ(error_of(error_code(tenths / 10.0)), tenths / 10.0);
}

TEST(ErrorLadder, RisesStrictlyFromZeroToInfinity) {
  EXPECT_EQ(error_of(0), 0);
  for (unsigned code = 1; code <= kAlwaysSelected; ++code) {
    EXPECT_LT(error_of(static_cast<ErrorCode>(code - 1)), error_of(static_cast<ErrorCode>(code))) << code;
  }
  EXPECT_EQ(error_of(kLastFiniteError), 1e7);
  EXPECT_EQ(error_of(kAlwaysSelected), kInfinity);
  EXPECT_EQ(error_of(65535), kInfinity);
}

TEST(ErrorLadder, ACodeOfItsOwnErrorIsItself) {
  for (unsigned code = 0; code <= kAlwaysSelected; ++code) {
    EXPECT_EQ(error_code(error_of(static_cast<ErrorCode>(code))), code);
  }
}

TEST(ErrorLadder, AnUlpBesideARungFallsToTheRightSide) {
  for (unsigned code = 1; code <= kLastFiniteError; ++code) {
    const double rung = error_of(static_cast<ErrorCode>(code));
    EXPECT_EQ(error_code(std::nextafter(rung, 0)), code);
    EXPECT_EQ(error_code(std::nextafter(rung, kInfinity)), code + 1);
  }
}

TEST(ErrorLadder, TheSmallestRungNotBelowIsTaken) {
  Random random(11);
  for (int i = 0; i < 200000; ++i) expect_smallest_not_below(random.log_between(1e-9, 3e7));
  for (int i = 0; i < 2000; ++i) expect_smallest_not_below(random.log_between(1e-150, 1e150));
}

TEST(ErrorLadder, HasAnAnswerForEveryNumber) {
  EXPECT_EQ(error_code(0.0), 0);
  EXPECT_EQ(error_code(std::numeric_limits<double>::denorm_min()), 1);
  EXPECT_EQ(error_code(std::numeric_limits<double>::min()), 1);
  EXPECT_EQ(error_code(static_cast<double>(std::numeric_limits<float>::denorm_min())), 1);
  EXPECT_EQ(error_code(std::nextafter(1e7, kInfinity)), kAlwaysSelected);
  EXPECT_EQ(error_code(std::numeric_limits<double>::max()), kAlwaysSelected);
  EXPECT_EQ(error_code(3.5e38), kAlwaysSelected);  // beyond a float
  EXPECT_EQ(error_code(kInfinity), kAlwaysSelected);
}

TEST(ErrorLadder, StepsByTwoAndAHalfPercentAtMostAboveATenthOfAMillimetre) {
  for (unsigned code = 41; code <= kLastFiniteError; ++code) {
    EXPECT_LE(error_of(static_cast<ErrorCode>(code)) / error_of(static_cast<ErrorCode>(code - 1)), 1.0251);
  }
}

// ---- selection -------------------------------------------------------------------------------------

TEST(LargestCodeWithin, IncludesATieAndNothingAnUlpAbove) {
  for (unsigned code = 1; code <= kLastFiniteError; ++code) {
    const double rung = error_of(static_cast<ErrorCode>(code));
    EXPECT_EQ(largest_code_within(rung), code);
    EXPECT_EQ(largest_code_within(std::nextafter(rung, 0)), code - 1);
    EXPECT_EQ(largest_code_within(std::nextafter(rung, kInfinity)), code);
  }
}

TEST(LargestCodeWithin, ZeroIsZeroAndInfinityIsAll) {
  EXPECT_EQ(largest_code_within(0), 0);
  EXPECT_EQ(largest_code_within(std::numeric_limits<double>::denorm_min()), 0);
  EXPECT_EQ(largest_code_within(1e300), kLastFiniteError);
  EXPECT_EQ(largest_code_within(kInfinity), kAlwaysSelected);
}

TEST(LargestCodeWithin, SelectsExactlyWhatTheErrorsWouldWhereTheToleranceIsARung) {
  Random random(12);
  for (int i = 0; i < 20000; ++i) {
    const double tolerance = error_of(static_cast<ErrorCode>(random.between(0, kLastFiniteError)));
    const double error = random.chance(0.3) ? tolerance : random.log_between(1e-6, 1e7);
    EXPECT_EQ(error_code(error) > largest_code_within(tolerance), error > tolerance) << error << " at " << tolerance;
  }
}

}  // namespace
}  // namespace talus::support
