#pragma once
// The heights of a page as whole numbers.

#include <cstdint>
#include <span>

namespace talus {

/// decimal k: the height is k / 10^d, rounded to float if the source was float. bits: the bits of the number, reordered
/// so that they rise with it.
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

/// The first coding of a fixed list that restores every needed height bit for bit. `needed` empty: all are needed.
[[nodiscard]] Coding choose_coding(std::span<const double> heights, std::span<const std::uint8_t> needed);

/// The number of each needed height; 0 for the others.
void numbers_of(std::span<const double> heights, std::span<const std::uint8_t> needed, Coding coding,
                std::span<std::int64_t> numbers);

/// heights[i] = height_of(base + numbers[i], coding).
void heights_of(std::int64_t base, std::span<const std::int32_t> numbers, Coding coding, double* heights);
void heights_of(std::int64_t base, std::span<const std::int64_t> numbers, Coding coding, double* heights);
[[nodiscard]] double height_of(std::int64_t number, Coding coding);

}  // namespace talus
