// Danger: 2^k + 1 samples a side. The last column begins a block, a page or a tile of its own, one sample wide, which
// whoever counts whole blocks never stores.

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

int naive_blocks(int samples, int side) { return samples / side; }

/// A wall in the last column and row, and one before it.
HardCase hard_case(int cols, int rows) {
  HardCase hard{.terrain = hills(cols, rows)};
  for (int row = 0; row < rows; ++row) hard.terrain.at(cols - 1, row) = row % 2 == 0 ? 9000 : -9000;
  for (int col = 0; col < cols; ++col) hard.terrain.at(col, rows - 1) = col % 3 == 0 ? 9000 : -9000;
  return hard;
}

TEST(SizesOfPowersOfTwoPlusOne, LoseTheirLastColumn) {
  for (const int side : {64, 128, 1024}) {
    const int stored = naive_blocks(side + 1, side) * side;
    EXPECT_LT(stored, side + 1);
  }
}

TEST(SizesOfPowersOfTwoPlusOne, KeepThePromise) {
  for (const int side : {3, 5, 9, 17, 33, 65, 129, 257}) {
    SCOPED_TRACE(side);
    HardDatabase(hard_case(side, side)).hold_to_the_promise();
  }
}

TEST(SizesOfPowersOfTwoPlusOne, KeepThePromiseAtTheSizeOfATile) {
  HardDatabase(hard_case(1025, 129)).hold_to_the_promise();
  HardDatabase(hard_case(65, 2049)).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
