// Danger: millimetre cells at a coordinate of 10⁸. A column's place found by adding up cells drifts away from where it
// is, by several thousandths of a cell over a thousand columns.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kCell = 0.001, kOrigin = 1e8;

double naive_x(double x0, int col) {
  double x = x0;
  for (int i = 0; i < col; ++i) x += kCell;
  return x;
}

HardCase hard_case() {
  HardCase hard{.terrain = hole(hills(1100, 140), 1000, 60, 1040, 70)};
  hard.file.geotransform = {kOrigin, kCell, 0, -kOrigin, 0, -kCell};
  hard.judging = {.cell_width_m = kCell * 0.999, .cell_height_m = kCell * 0.999};  // as exact as the doubles are
  return hard;
}

TEST(OriginAtAHundredMillion, DriftsWhenCellsAreAddedUp) {
  EXPECT_GT(std::abs(naive_x(kOrigin, 1024) - (kOrigin + 1024 * kCell)), kCell / 1000);
}

TEST(OriginAtAHundredMillion, KeepsThePromise) { HardDatabase(hard_case()).hold_to_the_promise(); }

TEST(OriginAtAHundredMillion, FindsSamplesByTheirCoordinates) {
  const HardDatabase database(hard_case());
  const GridMapping m = database.now().description().mapping;
  for (const int col : {1, 64, 1000, 1024, 1090}) {
    const GridRect found = database.now().region({m.x(col), m.y(90), m.x(col + 8), m.y(70)}).samples;
    EXPECT_EQ(found, (GridRect{{col, 70}, {col + 8, 90}}));
    const Frame frame = database.now().region({m.x(col), m.y(90), m.x(col + 8), m.y(70)}).frame;
    EXPECT_EQ(frame.west, col) << "what is clipped on a sample leaves no slivers of rounding beside it";
    EXPECT_EQ(frame.south, 90);
  }
  // Between samples it goes outward still.
  EXPECT_EQ(database.now().region({m.x(10.5), m.y(90.5), m.x(20.5), m.y(70.5)}).samples,
            (GridRect{{10, 70}, {21, 91}}));
}

}  // namespace
}  // namespace talus::support
