#include "engine/error/error_ladder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace detail {

ErrorLadder::ErrorLadder() {
  // Whole numbers over a power of ten: each rung is the double nearest to its decimal value, so it equals the tolerance
  // that a user types.
  for (unsigned n = 0; n <= 40; ++n) metres[n] = n * 25 / 1e7;
  for (unsigned decade = 0; decade < 11; ++decade) {
    const int power = static_cast<int>(decade) - 7;
    for (unsigned i = 1; i <= 360; ++i) {
      const double whole = (40 + i) * 25;
      metres[40 + 360 * decade + i] = power < 0 ? whole / std::pow(10.0, -power) : whole * std::pow(10.0, power);
    }
  }
  metres[kAlwaysSelected] = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < first_guess.size(); ++b) {
    const auto low = std::bit_cast<float>(static_cast<std::uint32_t>(b << 16));
    const auto rung = std::lower_bound(metres.begin(), metres.end(), static_cast<double>(low));
    first_guess[b] = static_cast<ErrorCode>(rung - metres.begin());
  }
}

const ErrorLadder error_ladder;

}  // namespace detail

ErrorCode largest_code_within(double tolerance_m) {
  const auto& metres = detail::error_ladder.metres;
  const auto above = std::upper_bound(metres.begin(), metres.end(), tolerance_m);
  return static_cast<ErrorCode>(above - metres.begin() - 1);
}

}  // namespace talus
