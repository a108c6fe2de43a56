// Danger: the smallest tolerance there is, and an error that is not much larger. Squared, as distances like to be
// compared, both are zero, and zero is not more than zero.

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kError = 1e-200, kSmallest = std::numeric_limits<double>::denorm_min();

bool naive_selects(double error, double tolerance) { return error * error > tolerance * tolerance; }

HardCase hard_case(double error) {
  HardCase hard{.terrain = plane(140, 130, 0, 0, 0)};
  hard.terrain.at(64, 65) = error;
  hard.terrain.at(33, 32) = -error;
  hard.file.type = SampleType::float64;
  hard.tolerances = {kSmallest, error / 2, error, 2 * error};
  return hard;
}

TEST(ToleranceSmallest, IsZeroSquared) {
  EXPECT_GT(kError, kSmallest);
  EXPECT_FALSE(naive_selects(kError, kSmallest));
}

TEST(ToleranceSmallest, KeepsThePromise) {
  for (const double error : {kError, 1e-15, 1e-7}) {
    const HardDatabase database(hard_case(error));
    database.hold_to_the_promise();
    EXPECT_TRUE(has_point(database.judged(kSmallest), {64, 65}));
    EXPECT_TRUE(has_point(database.judged(kSmallest), {33, 32}));
  }
}

}  // namespace
}  // namespace talus::support
