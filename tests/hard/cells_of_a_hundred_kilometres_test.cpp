// Danger: cells of a hundred kilometres beside voids. A triangle's ground side is longer than the largest error that
// can be stored, and longer than 32 bits of millimetres; cut off there, it would be drawn where it must not be.

#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kCell = 100000, kLargestStored = 1e7;

std::int32_t naive_side_mm(int cells) {
  return static_cast<std::int32_t>(
      static_cast<std::uint32_t>(static_cast<std::uint64_t>(kCell * 1000) * static_cast<std::uint64_t>(cells)));
}
double naive_stored_side_m(int cells) { return std::min(kCell * cells, kLargestStored); }

HardCase hard_case() {
  HardCase hard{.terrain = hole(hole(hills(1100, 140), 300, 40, 340, 60), 1020, 100, 1030, 139)};
  hard.file.geotransform = {0, kCell, 0, 0, 0, -kCell};
  hard.judging = {.cell_width_m = kCell, .cell_height_m = kCell};
  hard.tolerances = {kCell, 1e6, 1e7, 1.1e7, 2e7, 1e8, 1e9};
  return hard;
}

TEST(CellsOfAHundredKilometres, HaveSidesThatFitNowhere) {
  EXPECT_NE(naive_side_mm(128), std::int64_t{128} * 100000000);
  EXPECT_LT(naive_stored_side_m(128), 1.1e7) << "so a tolerance of 1.1e7 m would take a side of 1.28e7 m";
}

TEST(CellsOfAHundredKilometres, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  for (const double tolerance : {1e7, 1.1e7, 1.5e7, 2e7, 3e7}) (void)database.judged(tolerance);
}

}  // namespace
}  // namespace talus::support
