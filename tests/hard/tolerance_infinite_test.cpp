// Danger: an infinite tolerance meets errors that are infinite themselves, those of the root's corners. Their
// difference is no number; whoever selects by it drops the corners everything stands on.

#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool naive_selects(double error, double tolerance) { return error - tolerance >= 0; }

TEST(ToleranceInfinite, LeavesNoNumber) {
  EXPECT_TRUE(naive_selects(kInfinity, 1e300)) << "a corner is always selected";
  EXPECT_FALSE(naive_selects(kInfinity, kInfinity)) << "but not here";
}

TEST(ToleranceInfinite, KeepsThePromise) {
  for (const auto& [cols, rows] : {std::pair(1025, 129), std::pair(1100, 140), std::pair(33, 33)}) {
    const HardDatabase database({.terrain = hills(cols, rows)});
    database.hold_to_the_promise();
    const Mesh mesh = database.judged(kInfinity);
    for (const GridPoint corner : {GridPoint{0, 0}, {cols - 1, 0}, {0, rows - 1}, {cols - 1, rows - 1}}) {
      EXPECT_TRUE(has_point(mesh, corner));
    }
  }
}

TEST(ToleranceInfinite, KeepsThePromiseBesideVoids) {
  HardCase hard{.terrain = void_blobs(hills(1100, 140), 5, 8)};
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  HardDatabase(hard).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
