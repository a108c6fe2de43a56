// Danger: a tolerance one last digit below an error. As a float it is the error itself or more, and a vertex that the
// tolerance does not allow to leave out is left out.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kError = 0.1;
const double kBelow = std::nextafter(kError, 0.0);

bool naive_selects(double error, double tolerance) {
  return error > static_cast<double>(static_cast<float>(tolerance));
}

HardCase hard_case(int col, int row) {
  HardCase hard{.terrain = plane(1100, 140, 0, 0, 0)};
  hard.terrain.at(col, row) = kError;
  hard.file.type = SampleType::float64;
  hard.tolerances = {kBelow, kError, std::nextafter(kError, 1.0)};
  return hard;
}

TEST(ToleranceOneUlpBelow, IsNotBelowAsAFloat) {
  EXPECT_GT(kError, kBelow);
  EXPECT_FALSE(naive_selects(kError, kBelow));
}

TEST(ToleranceOneUlpBelow, KeepsThePromise) {
  for (const GridPoint p : {GridPoint{1023, 64}, {1024, 64}, {1025, 65}, {96, 96}}) {
    const HardDatabase database(hard_case(p.col, p.row));
    EXPECT_TRUE(has_point(database.judged(kBelow), p));
    EXPECT_EQ(database.judged(0.1025).points.size(), database.judged(1e9).points.size());
  }
  HardDatabase(hard_case(1024, 65)).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
