// Danger: whole numbers with a band scale of a thousandth: codes of 30 bits. A kernel that computes in floats because
// "codes are whole" loses their last digits, five centimetres and less.

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kScale = 0.001;

std::int64_t code(int col, int row) { return 999000000 + 13 * ((col * 5 + row * 9) % 17) * (col % 3 - 1); }

double naive_error_m(std::int64_t end, std::int64_t midpoint, std::int64_t other_end) {
  const float codes = static_cast<float>(midpoint) - (static_cast<float>(end) + static_cast<float>(other_end)) / 2;
  return static_cast<double>(std::abs(codes)) * kScale;
}

HardCase hard_case() {
  HardCase hard{.terrain = surface(1100, 140, code)};
  hard.file.type = SampleType::int32;
  hard.file.scale = kScale;
  hard.tolerances = {0.001, 0.0065, 0.01, 0.05, 0.2};
  return hard;
}

TEST(ScaledWholeNumbers, LoseTheirLastDigitsInFloats) {
  std::int64_t worst = 0;  // half codes
  for (int col = 1; col < 1100; col += 2) {
    const std::int64_t halves = 2 * code(col, 64) - code(col - 1, 64) - code(col + 1, 64);
    const double exact_m = static_cast<double>(std::abs(halves)) / 2 * kScale;
    const double naive_m = naive_error_m(code(col - 1, 64), code(col, 64), code(col + 1, 64));
    if (naive_m < exact_m) ++worst;
  }
  EXPECT_GT(worst, 0) << "errors that come out too small";
}

TEST(ScaledWholeNumbers, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
}

}  // namespace
}  // namespace talus::support
