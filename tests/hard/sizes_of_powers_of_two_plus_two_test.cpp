// Danger: 2^k + 2 samples a side. The last block has one cell, and its triangles belong to diamonds that lie almost
// wholly beyond the data; whoever counts whole blocks of cells drops it, with all that rises there.

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

int naive_cells(int samples, int side) { return (samples - 1) / side * side; }

HardCase hard_case(int cols, int rows) {
  HardCase hard{.terrain = hills(cols, rows)};
  for (int row = 0; row < rows; ++row) {
    hard.terrain.at(cols - 1, row) = row % 2 == 0 ? 9000 : -9000;
    hard.terrain.at(cols - 2, row) = row % 2 == 1 ? 9000 : -9000;
  }
  for (int col = 0; col < cols; ++col) hard.terrain.at(col, rows - 1) = col % 5 == 0 ? 9000 : 0;
  return hard;
}

TEST(SizesOfPowersOfTwoPlusTwo, LoseTheirLastCell) {
  for (const int side : {64, 128, 1024}) EXPECT_EQ(naive_cells(side + 2, side), side + 2 - 1 - 1);
}

TEST(SizesOfPowersOfTwoPlusTwo, KeepThePromise) {
  for (const int side : {4, 6, 10, 18, 34, 66, 130, 258}) {
    SCOPED_TRACE(side);
    HardDatabase(hard_case(side, side)).hold_to_the_promise();
  }
}

TEST(SizesOfPowersOfTwoPlusTwo, KeepThePromiseAtTheSizeOfATile) {
  HardDatabase(hard_case(1026, 130)).hold_to_the_promise();
  HardDatabase(hard_case(66, 2050)).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
