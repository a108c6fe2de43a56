// Danger: void weights of zero, of a million and of hardly anything, with ground sides that have no end beyond the
// root. Zero times infinity is no number, and no number is within every tolerance or none, by the way that one asks.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

double naive_error(double weight, double side) { return weight * side; }

HardCase hard_case(double weight, double cell) {
  HardCase hard{.terrain = void_blobs(hills(200, 140), 5, 4)};
  hard.file.geotransform = {0, cell, 0, 0, 0, -cell};
  hard.judging = {.cell_width_m = cell, .cell_height_m = cell};
  hard.void_weight = hard.judging.void_weight = weight;
  hard.tolerances = {weight, 4 * weight * cell, 1e-6, 1e6};
  return hard;
}

TEST(VoidWeights, OfZeroMakeNoNumber) {
  const double endless = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(naive_error(0, endless)));
  EXPECT_FALSE(naive_error(0, endless) > 5) << "so a triangle without end is within 5 m";
}

TEST(VoidWeights, KeepThePromise) {
  for (const double weight : {0.0, std::numeric_limits<double>::denorm_min(), 1e-300, 1e-6, 1e6}) {
    for (const double cell : {0.001, 100000.0}) {
      SCOPED_TRACE(::testing::Message() << "weight " << weight << ", cells of " << cell << " m");
      HardDatabase(hard_case(weight, cell)).hold_to_the_promise();
    }
  }
}

}  // namespace
}  // namespace talus::support
