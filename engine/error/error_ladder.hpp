#pragma once
// Stored errors: codes of sixteen bits for fixed decimal values (rungs), always rounded up.
//
// Many errors of integer heights are exactly round values, and people ask for round tolerances. The ladder has these
// values, so at a tolerance on it the codes select exactly the same vertices as the exact errors. Rungs: 40 steps of
// 2.5 µm up to 10⁻⁴ m, then 360 a decade (two significant digits and the quarters between them) up to 10⁷ m.

#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>

namespace talus {

using ErrorCode = std::uint16_t;

inline constexpr ErrorCode kLastFiniteError = 40 + 360 * 11;        ///< 10⁷ m
inline constexpr ErrorCode kAlwaysSelected = kLastFiniteError + 1;  ///< infinite, for root corners

namespace detail {

struct ErrorLadder {
  std::array<double, kAlwaysSelected + 1> metres{};
  /// For each float whose last sixteen bits are zero: the first rung that is not below it.
  std::array<ErrorCode, 0x7f81> first_guess{};
  ErrorLadder();
};
extern const ErrorLadder error_ladder;

}  // namespace detail

/// The error of a code in metres; infinity from kAlwaysSelected on.
[[nodiscard]] inline double error_of(ErrorCode code) {
  return detail::error_ladder.metres[code < kAlwaysSelected ? code : kAlwaysSelected];
}

/// The smallest code whose error is not below `metres` (>= 0, not NaN). A look-up and a few comparisons.
[[nodiscard]] inline ErrorCode error_code(double metres) {
  assert(metres >= 0);
  const auto& ladder = detail::error_ladder;
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(static_cast<float>(metres));
  std::size_t code = ladder.first_guess[bits >> 16 & 0x7fff];  // -0.0 is 0, too
  while (ladder.metres[code] < metres) ++code;
  while (code > 0 && ladder.metres[code - 1] >= metres) --code;
  return static_cast<ErrorCode>(code);
}

/// The largest code within a tolerance. A vertex is selected if its code is above it.
[[nodiscard]] ErrorCode largest_code_within(double tolerance_m);

}  // namespace talus
