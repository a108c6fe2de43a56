// Which vertices a tolerance selects, whatever the height step is.

#include "query/selection/threshold.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

CodeDistance steps_of(double scale, bool whole) { return CodeDistance({scale, 1, 0, whole}, 1); }

TEST(Threshold, IsTheLargestDistanceWithinTheTolerance) {
  Random random(3);
  for (int time = 0; time < 20000; ++time) {
    const CodeDistance distance =
        steps_of(std::pow(10, random.between(-9, 9)) * (1 + random.between(0, 9)), random.chance(0.5));
    const double tolerance = std::pow(10, random.between(-12, 9)) * random.between(0, 1000) / 7.0;
    SCOPED_TRACE(testing::Message() << tolerance << " m in steps of " << distance.metres(1));
    const Threshold above(tolerance, distance);
    ASSERT_GE(above.distance(), 0);
    ASSERT_LE(distance.metres(above.distance()), tolerance);
    if (!distance.is_whole()) {  // errors count as codes
      ASSERT_EQ(above.counted(), above.code());
      ASSERT_LE(error_of(above.code()), tolerance);
      ASSERT_GT(error_of(static_cast<ErrorCode>(above.code() + 1)), tolerance);
      ASSERT_LE(distance.metres(above.distance()), error_of(above.code()));
      ASSERT_GT(distance.metres(std::nextafter(above.distance(), 1e308)), error_of(above.code()));
      continue;
    }
    ASSERT_EQ(above.counted(), above.eighths());
    const bool in_eighths = above.eighths() < kMostEighths;
    const double next = in_eighths ? above.distance() + 0.125 : std::nextafter(above.distance(), 1e308);
    ASSERT_GT(distance.metres(next), tolerance);
    ASSERT_TRUE(!in_eighths || above.distance() == above.eighths() / 8.0);
  }
}

/// A vertex whose error is stored as a code is selected with one whose error is stored in eighths.
TEST(Threshold, CodesAndEighthsAreAboveItTogether) {
  Random random(4);
  for (const double scale : {1e-9, 1e-6, 1e-3, 0.1, 0.3, 1.0, 30.0, 1e6}) {
    const CodeDistance distance = steps_of(scale, true);
    for (int time = 0; time < 3000; ++time) {
      const auto code = static_cast<ErrorCode>(random.between(1, kAlwaysSelected - 1));
      const double exact = error_of(code);
      const double tolerance =
          random.chance(0.5) ? exact : exact * (1 + random.between(-300, 300) * scale / exact / 800);
      if (!(tolerance >= 0)) continue;
      SCOPED_TRACE(testing::Message() << exact << " m, tolerance " << tolerance << ", step " << scale);
      const Threshold above(tolerance, distance);
      const std::int32_t eighths = distance.eighths(exact);
      if (eighths == kMostEighths) {
        ASSERT_EQ(above(code), exact > tolerance);
      } else {
        ASSERT_EQ(above(code), eighths > above.eighths());
      }
      ASSERT_EQ(above(code), distance.up_to_eighths(code) > tolerance);
    }
  }
}

TEST(Threshold, HasEndsWithoutEnd) {
  for (const bool whole : {true, false}) {
    const CodeDistance metre = steps_of(1, whole);
    EXPECT_EQ(Threshold(-1, metre).eighths(), -1) << "everything is above";
    EXPECT_LT(Threshold(-1, metre).distance(), 0);
    EXPECT_TRUE(Threshold(0, metre)(1));
    EXPECT_FALSE(Threshold(0, metre)(0));
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_EQ(Threshold(infinite, metre).eighths(), kMostEighths);
    EXPECT_FALSE(Threshold(infinite, metre)(kAlwaysSelected));
    EXPECT_TRUE(Threshold(1e300, metre)(kAlwaysSelected));
    EXPECT_EQ(Threshold(0, steps_of(1e-300, whole)).eighths(), 0);
  }
}

}  // namespace
}  // namespace talus::support
