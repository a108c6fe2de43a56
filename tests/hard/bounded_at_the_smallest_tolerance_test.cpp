// Danger: heights as multiples of a quantum so small that the multiple is no number any more. A height over the
// smallest quantum is infinite, and infinity times the quantum is what the client gets.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kSmallest = std::numeric_limits<double>::denorm_min();

double naive_rounded(double height, double quantum) { return std::nearbyint(height / quantum) * quantum; }

HardCase hard_case(double size) {
  HardCase hard{.terrain = noise(70, 67, 12, -size, size)};
  hard.file.type = SampleType::float64;
  return hard;
}

TEST(BoundedAtTheSmallestTolerance, IsInfinite) {
  for (const double height : hard_case(1e6).terrain.values) ASSERT_TRUE(std::isinf(naive_rounded(height, kSmallest)));
}

TEST(BoundedAtTheSmallestTolerance, IsRefusedWhereMultiplesAreNoWholeNumbers) {
  const HardDatabase database(hard_case(1e6));
  for (const double tolerance : {kSmallest, 1e-310, 1e-200, 1e-12}) {
    const FloatExceptions watched;
    EXPECT_THROW(
        (void)database.now().ask(
            {.region = database.extent(), .tolerance = Metres{tolerance}, .heights = {.kind = HeightKind::bounded}}),
        Failure);
    EXPECT_THROW((void)database.now().ask({.region = database.extent(),
                                           .tolerance = Metres{tolerance},
                                           .heights = {.kind = HeightKind::bounded, .quantum = Metres{tolerance}}}),
                 Failure);
    EXPECT_EQ(watched.seen(), "");
  }
}

TEST(BoundedAtTheSmallestTolerance, KeepsThePromise) {
  for (const double size : {1e6, 1.0, 1e-300}) {
    const HardDatabase database(hard_case(size));
    for (const double tolerance : {1e-15, 1e-9, 1e-6, 1.0, 1e15}) {
      SCOPED_TRACE(::testing::Message() << "heights to " << size << ", tolerance " << tolerance * size);
      const Answer answer = without_float_exceptions([&] {
        return database.now().ask({.region = database.extent(),
                                   .tolerance = Metres{tolerance * size},
                                   .heights = {.kind = HeightKind::bounded}});
      });
      const Mesh mesh = database.streamed(answer.quadtree);
      for (const double height : mesh.heights) ASSERT_TRUE(std::isfinite(height));
    }
  }
}

}  // namespace
}  // namespace talus::support
