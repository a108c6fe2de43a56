// Danger: 2^k samples a side, one fewer than a square of the hierarchy has. Whoever fills up the missing column with
// zeros finds the error of the whole height in a raster that is flat.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kHeight = 3000;

/// The error of the vertex in the middle of a row of `cols` samples, filled up to 2^k + 1 with zeros.
double naive_error(int cols) {
  const auto at = [&](int col) { return col < cols ? kHeight : 0.0; };
  return std::abs(at(cols / 2) - (at(0) + at(cols)) / 2);
}

TEST(SizesOfPowersOfTwo, FilledWithZerosAreSteep) {
  for (const int side : {2, 64, 128, 1024}) EXPECT_EQ(naive_error(side), kHeight / 2);
}

TEST(SizesOfPowersOfTwo, KeepThePromise) {
  for (const int side : {2, 4, 8, 16, 32, 64, 128, 256}) {
    SCOPED_TRACE(side);
    HardDatabase({.terrain = hills(side, side)}).hold_to_the_promise();
    const HardDatabase flat({.terrain = plane(side, side, kHeight, 0, 0)});
    EXPECT_EQ(flat.judged(0).points.size(), flat.judged(1e9).points.size());
  }
}

TEST(SizesOfPowersOfTwo, KeepThePromiseAtTheSizeOfATile) {
  HardDatabase({.terrain = hills(1024, 128)}).hold_to_the_promise();
  HardDatabase({.terrain = hills(64, 2048)}).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
