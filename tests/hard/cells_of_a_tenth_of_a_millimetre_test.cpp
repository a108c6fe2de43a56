// Danger: cells of a tenth of a millimetre at coordinates of millions of metres. In floats all columns stand at one
// place, so every rectangle is empty or everything.

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kCell = 0.0001, kWest = 500000, kNorth = 5200000;

float naive_x(int col) { return static_cast<float>(kWest) + static_cast<float>(col) * static_cast<float>(kCell); }

HardCase hard_case() {
  HardCase hard{.terrain = void_blobs(hills(200, 150), 4, 3)};
  hard.file.crs = "EPSG:32632";
  hard.file.geotransform = {kWest, kCell, 0, kNorth, 0, -kCell};
  hard.judging = {.cell_width_m = kCell, .cell_height_m = kCell};
  hard.tolerances = {kCell, 5 * kCell, 0.01, 1};
  return hard;
}

TEST(CellsOfATenthOfAMillimetre, StandAtOnePlaceInFloats) { EXPECT_EQ(naive_x(0), naive_x(149)); }

TEST(CellsOfATenthOfAMillimetre, KeepThePromise) { HardDatabase(hard_case()).hold_to_the_promise(); }

TEST(CellsOfATenthOfAMillimetre, AreFoundByTheirCoordinates) {
  const HardDatabase database(hard_case());
  const GridMapping mapping = database.now().description().mapping;
  // Doubles place a coordinate here to a hundred-thousandth of a cell.
  EXPECT_EQ(database.now().region({mapping.x(60), mapping.y(90), mapping.x(100), mapping.y(70)}).samples,
            (GridRect{{60, 70}, {100, 90}}));
}

}  // namespace
}  // namespace talus::support
