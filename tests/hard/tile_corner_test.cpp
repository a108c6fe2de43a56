// Danger: a spike beside the corner where four tiles meet. It lies in one of them, but in the diamonds of vertices that
// belong to the others; whoever takes for a vertex the largest error of his own tile only, loses it.

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kHeight = 50;

/// The largest height among the samples of the tile that owns the corner (1024, 1024).
double naive_largest(const Terrain& terrain) {
  double largest = 0;
  for (int row = 1024; row < terrain.rows; ++row) {
    for (int col = 1024; col < terrain.cols; ++col) largest = std::max(largest, terrain.at(col, row) - 100);
  }
  return largest;
}

TEST(TileCorner, HidesASpikeFromItsOwnTile) { EXPECT_EQ(naive_largest(spike(1100, 1100, 1023, 1023, kHeight)), 0); }

TEST(TileCorner, KeepsThePromiseInEveryOneOfFour) {
  for (const GridPoint p : {GridPoint{1023, 1023}, {1025, 1023}, {1023, 1025}, {1025, 1025}, {1024, 1023}}) {
    SCOPED_TRACE(::testing::Message() << p.col << ", " << p.row);
    const HardDatabase database({.terrain = spike(1100, 1100, p.col, p.row, kHeight)});
    EXPECT_TRUE(has_point(database.judged({{900, 900}, {1099, 1099}}, kHeight - 1), p));
    EXPECT_FALSE(has_point(database.judged({{900, 900}, {1099, 1099}}, kHeight), p));
  }
}

TEST(TileCorner, KeepsThePromise) {
  HardCase hard{.terrain = spike(1100, 1100, 1023, 1023, kHeight)};
  hard.regions = {{{1000, 1001}, {1050, 1049}}, {{1023, 1023}, {1025, 1025}}, {{1024, 960}, {1099, 1099}}};
  hard.tolerances = {49, 50};
  HardDatabase(hard).hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
