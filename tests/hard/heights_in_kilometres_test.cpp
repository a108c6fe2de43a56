// Danger: heights in kilometres or feet, and tolerances in metres. Whoever compares the numbers without their units
// leaves out a sample that is five hundred metres off, or keeps ten times too many.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kTolerance = 1;  // metre

bool naive_selects(double error_in_units) { return error_in_units > kTolerance; }

HardCase hard_case(const char* unit, double metres, SampleType type) {
  HardCase hard{.terrain = fit(fractal(200, 140, 6, 900), type)};
  if (type == SampleType::float64) {
    for (double& height : hard.terrain.values) height = std::round(height) / 1000;
  }
  hard.terrain.at(65, 64) += type == SampleType::float64 ? 0.5 : 500;
  hard.file.type = type;
  hard.file.unit = unit;
  hard.metres_per_unit = metres;
  hard.tolerances = {1, metres, 3 * metres, 100};
  return hard;
}

TEST(HeightsInKilometres, LookWithinAMetre) {
  EXPECT_FALSE(naive_selects(0.5)) << "although it is 500 m";
  EXPECT_TRUE(naive_selects(3)) << "although three feet are 0.91 m";
}

TEST(HeightsInKilometres, KeepThePromise) {
  const HardDatabase database(hard_case("km", 1000, SampleType::float64));
  database.hold_to_the_promise();
  EXPECT_TRUE(has_point(database.judged(kTolerance), {65, 64}));
}

TEST(HeightsInKilometres, OrFeetKeepThePromise) {
  HardDatabase(hard_case("ft", 0.3048, SampleType::int16)).hold_to_the_promise();
  HardDatabase(hard_case("us-ft", 1200.0 / 3937, SampleType::int16)).hold_to_the_promise();
  HardDatabase(hard_case("ft", 0.3048, SampleType::float32)).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
