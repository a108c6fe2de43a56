#include "engine/height_field.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace talus {

CodeDistance::CodeDistance(const HeightStep& step, double metres_per_unit) {
  const double scale = std::abs(step.scale), per_unit = std::round(1 / scale);
  const bool is_fraction = scale < 1 && std::abs(scale * per_unit - 1) < 3e-16;  // the double nearest to 1/n
  factor_ = (is_fraction ? 1 : scale) * metres_per_unit;
  divisor_ = step.divisor * (is_fraction ? per_unit : 1);
}

bool CodeDistance::is_binary() const {
  int unused = 0;
  return std::frexp(factor_, &unused) == 0.5 && std::frexp(divisor_, &unused) == 0.5;
}

bool interpolation_is_exact(std::span<const double> heights, std::int32_t side) {
  int finest = 1100, coarsest = -1100;  // exponents of the lowest and highest bit in use
  for (const double h : heights) {
    if (h == 0) continue;
    const auto bits = std::bit_cast<std::uint64_t>(h);
    const int exponent = static_cast<int>(bits >> 52 & 0x7ff);
    if (exponent == 0 || exponent == 0x7ff) return false;  // denormal: let the margin cover it
    const std::uint64_t mantissa = (bits & ((std::uint64_t{1} << 52) - 1)) | std::uint64_t{1} << 52;
    finest = std::min(finest, exponent - 1075 + std::countr_zero(mantissa));
    coarsest = std::max(coarsest, exponent - 1023);
  }
  // Differences and sums of up to three terms need two bits above, division by the side log2(side) below.
  const int below = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(side))) + 1;
  return finest > coarsest || coarsest + 3 - (finest - below) <= 53;
}

bool are_whole_numbers(std::span<const double> heights) {
  return std::all_of(heights.begin(), heights.end(), [](double h) { return h == std::nearbyint(h); });
}

}  // namespace talus
