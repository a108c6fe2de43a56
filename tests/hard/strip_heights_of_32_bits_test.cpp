// Danger: a strip whose heights take all of 32 bits, and one whose heights take none. Read as signed numbers half of
// the former lie below the lowest; and of a range of zero the logarithm is minus infinity.

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "talus/strip.hpp"
#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kStep = 0x1p-11, kLow = -1000000;
constexpr std::uint32_t kSteps = 4096000000u;  // from -10⁶ m to 10⁶ m

double naive_height(std::uint32_t steps) { return kLow + kStep * static_cast<std::int32_t>(steps); }

/// From the lowest height to the highest, any step between them.
HardCase hard_case() {
  Random random(9);
  HardCase hard{.terrain = surface(90, 70, [&](int col, int row) {
                  const auto steps = col + row == 0 ? 0u : col == 40 && row == 33 ? kSteps : random.next() % kSteps;
                  return kLow + kStep * static_cast<double>(steps);
                })};
  hard.file.type = SampleType::float64;
  return hard;
}

/// The strip's heights, and those of its bytes beside them.
void expect_heights_within(const HardDatabase& database, double tolerance, double step) {
  const auto answer = database.now().ask({.region = database.extent(), .tolerance = Metres{tolerance}}).quadtree;
  const TriangleStrip strip = strip_of(answer);
  EXPECT_EQ(strip.triangles(), triangulate(answer).triangles.size());
  const auto bytes = without_float_exceptions([&] { return encode_strip(strip, {step}); });
  const Mesh written = mesh_of(strip);
  for (const int threads : {1, 2}) {
    const Mesh read = without_float_exceptions([&] { return decode_strip(bytes, threads); });
    ASSERT_EQ(read.triangles.size(), written.triangles.size());
    for (std::size_t t = 0; t < read.triangles.size(); ++t) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t at = read.triangles[t][i], was = written.triangles[t][i];
        ASSERT_EQ(read.points[at], written.points[was]);
        ASSERT_LE(std::abs(read.heights[at] - written.heights[was]), step / 2);
      }
    }
  }
}

TEST(StripHeightsOf32Bits, LieBelowTheLowestAsSignedNumbers) {
  int below = 0;
  for (const double height : hard_case().terrain.values) {
    below += naive_height(static_cast<std::uint32_t>((height - kLow) / kStep)) < kLow;
  }
  EXPECT_GT(below, 90 * 70 / 3);
  EXPECT_FALSE(std::isfinite(std::log2(0.0 / kStep))) << "and one height has no number of bits";
}

TEST(StripHeightsOf32Bits, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  for (const double tolerance : {0.0, 1000.0, 1e5}) {
    expect_heights_within(database, tolerance, kStep);
    expect_heights_within(database, tolerance, 1);
    expect_heights_within(database, tolerance, 1e7);
  }
  const TriangleStrip strip =
      strip_of(database.now().ask({.region = database.extent(), .tolerance = Metres{0}}).quadtree);
  EXPECT_THROW((void)encode_strip(strip, {kStep / 4}), Failure) << "34 bits";
}

TEST(StripHeightsOf32Bits, OfOneHeightKeepThePromise) {
  const HardDatabase database({.terrain = plane(90, 70, 417, 0, 0)});
  expect_heights_within(database, 0, 1);
  expect_heights_within(database, 0, 1e-3);
}

}  // namespace
}  // namespace talus::support
