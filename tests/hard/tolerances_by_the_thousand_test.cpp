// Danger: a thousand tolerances, one a little above the other. A rung found by a quotient of logarithms lies one too
// low at a thousand, so a wider tolerance gives vertices that a tighter one has not.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

int naive_rung(double metres) { return static_cast<int>(std::log(metres) / std::log(10.0) * 360); }

TEST(TolerancesByTheThousand, FallBetweenRungsOfLogarithms) { EXPECT_LT(naive_rung(1000), 3 * 360); }

TEST(TolerancesByTheThousand, KeepThePromise) {
  HardCase hard{.terrain = fit(fractal(150, 100, 4, 4000), SampleType::int16)};
  HardDatabase(hard).hold_to_the_promise();
}

TEST(TolerancesByTheThousand, NeverGiveMoreForLess) {
  const HardDatabase database({.terrain = fit(fractal(150, 100, 4, 4000), SampleType::int16)});
  VertexMask finer = database.now().ask({.region = database.extent(), .tolerance = Metres{0}}).quadtree.vertices;
  for (int i = 0; i < 1000; ++i) {
    const double tolerance = std::pow(10.0, -1 + i / 200.0);
    const RestrictedQuadtree answer =
        database.now().ask({.region = database.extent(), .tolerance = Metres{tolerance}}).quadtree;
    std::size_t strange = 0;
    answer.vertices.for_each([&](GridPoint p) { strange += !finer.contains(p); });
    ASSERT_EQ(strange, 0u) << tolerance;
    if (i % 100 == 0) (void)database.judged(tolerance);
    finer = answer.vertices;
  }
}

}  // namespace
}  // namespace talus::support
