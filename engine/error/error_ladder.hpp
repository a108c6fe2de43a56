#pragma once
// Stored errors: sixteen-bit codes on a ladder of decimal values, always rounded up.
//
// Errors of integer heights sit in great numbers exactly on round values, and people ask for round
// tolerances. A ladder with those values on it keeps ties where they are: at a tolerance on the ladder
// the stored codes select exactly the vertices the exact errors would. Rungs: 40 steps of 2.5 µm up to
// 10⁻⁴ m, then 360 a decade (two significant digits and the quarters between) up to 10⁷ m.

#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>

namespace talus {

using ErrorCode = std::uint16_t;

inline constexpr ErrorCode kLastFiniteError = 40 + 360 * 11;        ///< 10⁷ m
inline constexpr ErrorCode kAlwaysSelected = kLastFiniteError + 1;  ///< infinite: root corners

namespace detail {

struct ErrorLadder {
  std::array<double, kAlwaysSelected + 1> metres{};
  /// The first rung not below each float that ends in sixteen zero bits.
  std::array<ErrorCode, 0x7f81> first_guess{};
  ErrorLadder();
};
extern const ErrorLadder error_ladder;

}  // namespace detail

/// Metres of a code; infinity from kAlwaysSelected on.
[[nodiscard]] inline double error_of(ErrorCode code) {
  return detail::error_ladder.metres[code < kAlwaysSelected ? code : kAlwaysSelected];
}

/// The smallest code whose error is not below `metres` (>= 0; not NaN). A look-up and a few comparisons.
[[nodiscard]] inline ErrorCode error_code(double metres) {
  assert(metres >= 0);
  const auto& ladder = detail::error_ladder;
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(static_cast<float>(metres));
  std::size_t code = ladder.first_guess[bits >> 16 & 0x7fff];  // -0.0 is 0, too
  while (ladder.metres[code] < metres) ++code;
  while (code > 0 && ladder.metres[code - 1] >= metres) --code;
  return static_cast<ErrorCode>(code);
}

/// The largest code whose error is within a tolerance: a vertex is selected iff its code is above it.
[[nodiscard]] ErrorCode largest_code_within(double tolerance_m);

}  // namespace talus
