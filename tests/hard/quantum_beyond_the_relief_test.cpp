// Danger: heights sent as multiples of a quantum far larger than the relief. Whoever cuts them off to multiples drops
// one side of a hill of six metres by eight hundred, more than twice the tolerance.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kQuantum = 800, kTolerance = 400;

double naive_rounded(double height) { return std::trunc(height / kQuantum) * kQuantum; }

HardCase hard_case(SampleType type) {
  HardCase hard{.terrain = surface(140, 130, [](int col, int row) { return 797 + (col * 5 + row * 3) % 7; })};
  hard.file.type = type;
  return hard;
}

TEST(QuantumBeyondTheRelief, IsBrokenByCuttingOff) {
  const Terrain terrain = hard_case(SampleType::int16).terrain;
  double largest = 0;
  for (const double height : terrain.values) largest = std::max(largest, std::abs(height - naive_rounded(height)));
  EXPECT_GT(largest, 2 * kTolerance - 10);
}

TEST(QuantumBeyondTheRelief, KeepsThePromise) {
  for (const SampleType type : {SampleType::int16, SampleType::float64}) {
    const HardDatabase database(hard_case(type));
    database.hold_to_the_promise();
    const Answer answer = without_float_exceptions([&] {
      return database.now().ask({.region = database.extent(),
                                 .tolerance = Metres{kTolerance},
                                 .heights = {.kind = HeightKind::bounded, .quantum = Metres{kQuantum}}});
    });
    const Mesh mesh = database.streamed(answer.quadtree);
    for (const double height : mesh.heights) ASSERT_EQ(height, kQuantum);
  }
}

TEST(QuantumBeyondTheRelief, OfAnyLargerSizeKeepsThePromise) {
  const HardDatabase database(hard_case(SampleType::float64));
  for (const double tolerance : {1000.0, 1e6, 1e12, 1e300}) {
    const Answer answer = without_float_exceptions([&] {
      return database.now().ask(
          {.region = database.extent(), .tolerance = Metres{tolerance}, .heights = {.kind = HeightKind::bounded}});
    });
    (void)database.streamed(answer.quadtree);
  }
}

}  // namespace
}  // namespace talus::support
