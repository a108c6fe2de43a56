#include "engine/page/page_numbers.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/machine/cpu.hpp"

namespace talus {
namespace {

constexpr double kPowers[] = {1, 10, 100, 1000};
constexpr double kLargestDecimal = 4e9;

std::int64_t rising(std::int32_t bits) { return bits ^ ((bits >> 31) & 0x7fffffff); }
std::int64_t rising(std::int64_t bits) { return bits ^ ((bits >> 63) & 0x7fffffffffffffff); }

/// Ten to the power of a coding's decimals; 0 for float bits.
double power_of(Coding coding) {
  const int c = static_cast<int>(coding);
  if (coding >= Coding::float_bits) return 0;
  return kPowers[coding >= Coding::float_decimal1 ? c - 3 : c];
}
bool is_float(Coding coding) { return coding >= Coding::float_decimal1 && coding <= Coding::float_bits; }

std::int64_t number_of(double h, Coding coding) {
  if (coding == Coding::float_bits) return rising(std::bit_cast<std::int32_t>(static_cast<float>(h)));
  if (coding == Coding::double_bits) return rising(std::bit_cast<std::int64_t>(h));
  return std::llrint(h * power_of(coding));
}

bool is_same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

/// Whether each height is the decimal nearest to it; 2^20 samples at a time, without branches.
bool restores(std::span<const double> heights, std::span<const std::uint8_t> needed, Coding coding) {
  const auto restored = [&](double h) {
    if (coding == Coding::float_bits) return is_same(static_cast<double>(static_cast<float>(h)), h) || h != h;
    return std::abs(h) <= kLargestDecimal && is_same(height_of(number_of(h, coding), coding), h);
  };
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if ((needed.empty() || needed[i] != 0) && !restored(heights[i])) return false;
  }
  return true;
}

/// The usual page, tested without branches: whole numbers that fit in 32 bits, and no -0.
TALUS_CLONES bool all_small_whole(const double* heights, std::size_t count) {
  int others = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double h = heights[i], cut = h > -2e9 ? (h < 2e9 ? h : 0.5) : 0.5;
    const double back = static_cast<double>(static_cast<std::int32_t>(cut));
    others |= std::bit_cast<std::uint64_t>(back) != std::bit_cast<std::uint64_t>(h) ? 1 : 0;
  }
  return others == 0;
}

}  // namespace

double height_of(std::int64_t k, Coding coding) {
  if (coding == Coding::float_bits) {
    const auto narrow = static_cast<std::int32_t>(k);
    return static_cast<double>(std::bit_cast<float>(static_cast<std::int32_t>(rising(narrow))));
  }
  if (coding == Coding::double_bits) return std::bit_cast<double>(rising(k));
  const double value = static_cast<double>(k) / power_of(coding);
  return is_float(coding) ? static_cast<double>(static_cast<float>(value)) : value;
}

namespace {

/// Decimals so small that base and number can be added as doubles.
TALUS_CLONES void decimals_of(double base, const std::int32_t* numbers, std::size_t count, double per_unit,
                              bool is_float_source, double* heights) {
  if (is_float_source) {
    for (std::size_t i = 0; i < count; ++i)
      heights[i] = static_cast<double>(static_cast<float>((base + numbers[i]) / per_unit));
  } else if (per_unit != 1) {
    for (std::size_t i = 0; i < count; ++i) heights[i] = (base + numbers[i]) / per_unit;
  } else {
    for (std::size_t i = 0; i < count; ++i) heights[i] = base + numbers[i];
  }
}

std::int64_t plus(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

}  // namespace

void heights_of(std::int64_t base, std::span<const std::int32_t> numbers, Coding coding, double* heights) {
  constexpr std::int64_t kExact = std::int64_t{1} << 52;
  if (coding < Coding::float_bits && base > -kExact && base < kExact) {
    decimals_of(static_cast<double>(base), numbers.data(), numbers.size(), power_of(coding), is_float(coding), heights);
  } else {
    for (std::size_t i = 0; i < numbers.size(); ++i) heights[i] = height_of(plus(base, numbers[i]), coding);
  }
}
void heights_of(std::int64_t base, std::span<const std::int64_t> numbers, Coding coding, double* heights) {
  for (std::size_t i = 0; i < numbers.size(); ++i) heights[i] = height_of(plus(base, numbers[i]), coding);
}

Coding choose_coding(std::span<const double> heights, std::span<const std::uint8_t> needed) {
  if (needed.empty() && all_small_whole(heights.data(), heights.size())) return Coding::whole;
  for (const Coding c : {Coding::whole, Coding::float_decimal1, Coding::decimal1, Coding::float_decimal2,
                         Coding::decimal2, Coding::float_decimal3, Coding::decimal3, Coding::float_bits}) {
    if (restores(heights, needed, c)) return c;
  }
  return Coding::double_bits;
}

void numbers_of(std::span<const double> heights, std::span<const std::uint8_t> needed, Coding coding,
                std::span<std::int64_t> numbers) {
  if (coding == Coding::whole && needed.empty()) {
    std::transform(heights.begin(), heights.end(), numbers.begin(),
                   [](double h) { return static_cast<std::int64_t>(h); });
    return;
  }
  for (std::size_t i = 0; i < heights.size(); ++i) {
    numbers[i] = needed.empty() || needed[i] != 0 ? number_of(heights[i], coding) : 0;
  }
}

}  // namespace talus
