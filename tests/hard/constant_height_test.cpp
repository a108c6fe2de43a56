// Danger: a raster of one height. Its range is zero, and whatever is divided by the range is no number.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

[[gnu::no_sanitize("float-divide-by-zero")]] double naive_relative_error(double error, double low, double high) {
  return error / (high - low);
}

HardCase hard_case(SampleType type, double height) {
  HardCase hard{.terrain = fit(plane(1100, 140, height, 0, 0), type)};
  hard.file.type = type;
  return hard;
}

void expect_promise_and_nothing_more(const HardCase& hard) {
  const HardDatabase database(hard);
  database.hold_to_the_promise();
  EXPECT_EQ(database.judged(0).points.size(), database.judged(1e9).points.size()) << "only the border needs vertices";
}

TEST(ConstantHeight, DividedByItsRangeIsNoNumber) {
  const double height = 417;
  EXPECT_TRUE(std::isnan(naive_relative_error(0, height, height)));
  EXPECT_FALSE(naive_relative_error(0, height, height) <= 1) << "so every vertex would be selected";
}

TEST(ConstantHeight, InWholeNumbersKeepsThePromise) {
  expect_promise_and_nothing_more(hard_case(SampleType::int16, 417));
  expect_promise_and_nothing_more(hard_case(SampleType::uint8, 255));
}

TEST(ConstantHeight, InFloatsKeepsThePromise) {
  expect_promise_and_nothing_more(hard_case(SampleType::float32, 417.3));
  expect_promise_and_nothing_more(hard_case(SampleType::float64, 417.3));
}

}  // namespace
}  // namespace talus::support
