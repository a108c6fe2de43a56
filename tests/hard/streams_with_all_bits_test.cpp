// Danger: streams of doubles that need every bit, of denormals and of zeros of both signs. Whoever sends the difference
// from a prediction and adds it up again has other numbers: rounded ones, and zeros without their sign.

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kSmallest = std::numeric_limits<double>::denorm_min();

/// Sent as a difference from the prediction.
double naive_sent(double height, double predicted) { return predicted + (height - predicted); }

double height(int col, int row) {
  Random random(static_cast<std::uint64_t>(row) * 1000 + static_cast<std::uint64_t>(col));
  switch (col / 16 % 5) {
    case 0: return random.within(-1e6, 1e6);
    case 1: return random.chance(0.5) ? -0.0 : 0.0;
    case 2: return kSmallest * random.between(-3, 3);
    case 3: return std::nextafter(1.0, random.chance(0.5) ? 0.0 : 2.0);
    default: return random.log_between(1e-300, 1e6);
  }
}

HardCase hard_case() {
  HardCase hard{.terrain = surface(150, 90, height)};
  hard.file.type = SampleType::float64;
  hard.tolerances = {kSmallest, 1e-16, 1};
  return hard;
}

TEST(StreamsWithAllBits, AreOthersOnceAddedUp) {
  const Terrain terrain = hard_case().terrain;
  int rounded = 0, signs = 0;
  for (int row = 0; row < terrain.rows; ++row) {
    for (int col = 1; col + 1 < terrain.cols; col += 2) {
      const double h = terrain.at(col, row), predicted = (terrain.at(col - 1, row) + terrain.at(col + 1, row)) / 2;
      const double sent = naive_sent(h, predicted);
      rounded += sent != h;
      signs += sent == h && std::bit_cast<std::uint64_t>(sent) != std::bit_cast<std::uint64_t>(h);
    }
  }
  EXPECT_GT(rounded, 100);
  EXPECT_GT(signs, 100);
}

TEST(StreamsWithAllBits, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  for (const double tolerance : {0.0, kSmallest, 1e-16, 1.0, 1e5}) {
    (void)database.streamed(database.now().ask({.region = database.extent(), .tolerance = Metres{tolerance}}).quadtree);
  }
}

TEST(StreamsWithAllBits, OfFloatsKeepThePromise) {
  HardCase hard = hard_case();
  hard.terrain = fit(hard.terrain, SampleType::float32);
  hard.file.type = SampleType::float32;
  const HardDatabase database(hard);
  database.hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
