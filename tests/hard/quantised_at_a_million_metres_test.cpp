// Danger: heights of plus and minus a million metres as multiples of a millimetre and less. The multiples need 33 bits
// with their sign; a float has 24, and what it makes of them is off by many times the tolerance.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kQuantum = 0.0005, kTolerance = 0.005;

double height(int col, int row) {
  const double tenths = (col * 7 + row * 3) % 111;  // of a millimetre
  return (col < 70 ? 9999990000 + tenths : -9999990000 - tenths) / 10000;
}

double naive_rounded(double height) {
  return static_cast<double>(static_cast<float>(std::nearbyint(height / kQuantum)) * static_cast<float>(kQuantum));
}

HardCase hard_case() {
  HardCase hard{.terrain = surface(140, 90, height)};
  hard.file.type = SampleType::float64;
  hard.tolerances = {kQuantum, kTolerance};
  return hard;
}

TEST(QuantisedAtAMillionMetres, LeavesItsToleranceInFloats) {
  double largest = 0;
  for (const double h : hard_case().terrain.values) largest = std::max(largest, std::abs(h - naive_rounded(h)));
  EXPECT_GT(largest, 5 * kTolerance);
}

TEST(QuantisedAtAMillionMetres, KeepsThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  for (const double tolerance : {kQuantum, kTolerance, 1.0, 1e6}) {
    const Answer answer = without_float_exceptions([&] {
      return database.now().ask({.region = database.extent(),
                                 .tolerance = Metres{tolerance},
                                 .heights = {.kind = HeightKind::bounded, .quantum = Metres{kQuantum}}});
    });
    (void)database.streamed(answer.quadtree);
  }
}

/// Multiples of 0.05 are no doubles: those stored are off by as much as doubles are apart there, and the bound says so.
TEST(QuantisedAtAMillionMetres, TheBoundCountsInThatMultiplesAreRounded) {
  constexpr double kTwentieth = 0.05;
  HardCase hard{.terrain = surface(
                    60, 40, [](int col, int row) { return 999990 + ((col * 7 + row * 3) % 111 + 0.5) * kTwentieth; })};
  hard.file.type = SampleType::float64;
  const HardDatabase database(hard);
  const RestrictedQuadtree answer = database.now()
                                        .ask({.region = database.extent(),
                                              .tolerance = Metres{kTwentieth / 2},
                                              .heights = {.kind = HeightKind::bounded, .quantum = Metres{kTwentieth}}})
                                        .quadtree;
  long double largest = 0;
  std::size_t i = 0;
  answer.vertices.for_each([&](GridPoint p) {
    largest =
        std::max(largest, std::abs(static_cast<long double>(answer.heights[i++]) - hard.terrain.at(p.col, p.row)));
  });
  EXPECT_GT(largest, static_cast<long double>(kTwentieth) / 2) << "half a quantum is not all";
  EXPECT_LE(largest, answer.bound.value);
  EXPECT_LE(answer.bound.value, kTwentieth / 2 + 1e-8);
}

}  // namespace
}  // namespace talus::support
