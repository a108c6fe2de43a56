// Danger: floats of both signs, every second one void. A void that no triangle needs is stored as nothing, and what
// stands in its place when it is read, halfway between the bits of its neighbours, is a number beyond all heights,
// which no quantum fits.

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

/// Halfway between bits turned so that they rise with the values.
double naive_middle(double a, double b) {
  const auto ordered = [](double v) {
    const auto bits = std::bit_cast<std::int64_t>(v);
    return bits ^ ((bits >> 63) & std::numeric_limits<std::int64_t>::max());
  };
  const std::int64_t middle = (ordered(a) >> 1) + (ordered(b) >> 1);
  return std::bit_cast<double>(middle ^ ((middle >> 63) & std::numeric_limits<std::int64_t>::max()));
}

HardCase hard_case(SampleType type, bool beside_data) {
  HardCase hard{.terrain = surface(24, 24, [&](int col, int row) {
                  const double height = 1.1 * col - 2.3 * row + 0.123456789012;
                  return type == SampleType::float32 ? static_cast<double>(static_cast<float>(height)) : height;
                })};
  for (int row = 0; row < 24; ++row) {
    for (int col = 0; col < 24; ++col) {
      if ((col + row) % 2 == 0 && (!beside_data || col < 12)) hard.terrain.make_void(col, row);
    }
  }
  hard.file.type = type;
  hard.voids_are_nan = true;
  return hard;
}

TEST(VoidCheckerboardOfFloats, HasNoHeightBetweenItsBits) {
  EXPECT_LT(std::abs(naive_middle(-25, 12)), 1e-200) << "hardly any of -25 to 12 m lies there";
  EXPECT_GT(std::abs(naive_middle(1e300, 12)), 1e100);
}

TEST(VoidCheckerboardOfFloats, KeepsThePromise) {
  for (const SampleType type : {SampleType::float32, SampleType::float64}) {
    for (const bool beside_data : {false, true}) {
      SCOPED_TRACE(::testing::Message() << to_string(type) << (beside_data ? " beside data" : ""));
      const HardDatabase database(hard_case(type, beside_data));
      database.hold_to_the_promise();
      const Snapshot& now = database.now();
      const Description& d = now.description();
      for (const GridRect region : {database.extent(), GridRect{{2, 3}, {20, 21}}, GridRect{{2, 16}, {6, 21}}}) {
        for (const double tolerance : {1e-6, 1e-3, 1.0}) {
          for (const Answer& answer :
               {now.ask({.region = region, .tolerance = Metres{tolerance}}),
                now.ask({.region = region, .tolerance = Metres{tolerance}, .heights = {.kind = HeightKind::bounded}}),
                now.ask({.region = region, .tolerance = Metres{tolerance}, .heights = {.kind = HeightKind::dense}}),
                now.ask({.region = region, .tolerance = Metres{tolerance}, .heights = {.kind = HeightKind::fitted}}),
                now.ask({.region = region,
                .tolerance = Metres{tolerance},
                .heights = {.kind = HeightKind::bounded, .quantum = Metres{1e-6}}})}) {
            for (const double height : answer.quadtree.heights)
              EXPECT_TRUE(height == 0 || (height >= d.minimum_height - 1.1 && height <= d.maximum_height + 1.1))
                  << height;
            static_cast<void>(database.streamed(answer.quadtree));
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace talus::support
