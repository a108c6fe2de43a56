// Danger: a point on a line of samples, with voids on one side of the line. Their weight is zero; if they are NaN, zero
// times them is NaN, and the height of a sample that is there is none.

#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double naive_height(const Terrain& t, double col, double row) {
  const int c = static_cast<int>(col), r = static_cast<int>(row);
  const auto at = [&](int dc, int dr) { return t.is_valid(c + dc, r + dr) ? t.at(c + dc, r + dr) : kNan; };
  const double u = col - c, v = row - r;
  return (1 - v) * ((1 - u) * at(0, 0) + u * at(1, 0)) + v * ((1 - u) * at(0, 1) + u * at(1, 1));
}

/// Data up to row 64 and column 64, voids beyond; heights that are no bit's multiple of a mean.
HardCase hard_case() {
  HardCase hard{.terrain = hole(hole(noise(140, 90, 5, 300, 900), 65, 0, 139, 89), 0, 65, 139, 89)};
  hard.file.type = SampleType::float64;
  hard.file.nodata = kNan;
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  return hard;
}

TEST(PointBesideAVoid, IsNoNumberByWeights) {
  EXPECT_TRUE(std::isnan(naive_height(hard_case().terrain, 10.5, 64)));
  EXPECT_TRUE(std::isnan(naive_height(hard_case().terrain, 64, 64)));
}

TEST(PointBesideAVoid, KeepsThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const Terrain& t = database.truth();
  const GridMapping m = database.now().description().mapping;
  const auto height = [&](double col, double row) {
    return without_float_exceptions([&] { return database.now().height(m.x(col), m.y(row)); });
  };
  EXPECT_EQ(height(64, 64), t.at(64, 64)) << "bit for bit";
  EXPECT_EQ(height(0, 64), t.at(0, 64));
  for (const double col : {0.5, 10.25, 63.75}) {
    const int c = static_cast<int>(col);
    const auto found = height(col, 64);
    ASSERT_TRUE(found.has_value()) << col;
    EXPECT_NEAR(*found, t.at(c, 64) + (col - c) * (t.at(c + 1, 64) - t.at(c, 64)), 1e-9);
    EXPECT_FALSE(height(col, 64.001).has_value()) << "a thousandth of a cell beyond";
    // On a surface at tolerance 0 the same: the line is an edge of its triangles.
    const auto on_surface = database.now().height(m.x(col), m.y(64), Metres{0});
    ASSERT_TRUE(on_surface.has_value());
    EXPECT_NEAR(*on_surface, *found, 1e-9);
  }
}

}  // namespace
}  // namespace talus::support
