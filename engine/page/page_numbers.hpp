#pragma once
// How the heights of a page become whole numbers.

#include <cstdint>
#include <span>

namespace talus {

/// A decimal k stands for k / 10^d, rounded to float where the source was one; bits are the number's own,
/// reordered so that they rise with it.
enum class Coding : std::uint8_t {
  whole = 0,
  decimal1 = 1,
  decimal2 = 2,
  decimal3 = 3,
  float_decimal1 = 4,
  float_decimal2 = 5,
  float_decimal3 = 6,
  float_bits = 7,
  double_bits = 8,
};
inline constexpr std::uint8_t kCodings = 9;

/// The first of a fixed ladder that restores every height bit for bit; heights where `needed` is 0 do not matter.
/// `needed` empty: all do.
[[nodiscard]] Coding choose_coding(std::span<const double> heights, std::span<const std::uint8_t> needed);

/// heights[i] as a number, where needed; else 0.
void numbers_of(std::span<const double> heights, std::span<const std::uint8_t> needed, Coding coding,
                std::span<std::int64_t> numbers);

/// heights[i] = height_of(base + numbers[i], coding), many at once.
void heights_of(std::int64_t base, std::span<const std::int32_t> numbers, Coding coding, double* heights);
void heights_of(std::int64_t base, std::span<const std::int64_t> numbers, Coding coding, double* heights);
[[nodiscard]] double height_of(std::int64_t number, Coding coding);

}  // namespace talus
