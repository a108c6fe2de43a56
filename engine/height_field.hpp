#pragma once
// Heights of a whole rectangle as the error computation sees them.

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "talus/description.hpp"
#include "talus/units.hpp"

namespace talus {

/// From a distance in height codes to metres.
class CodeDistance {
 public:
  CodeDistance() = default;
  CodeDistance(const HeightStep& step, double metres_per_unit);
  [[nodiscard]] double metres(double codes) const { return codes * factor_ / divisor_; }
  /// Metres are a whole power of two of codes: no conversion rounds.
  [[nodiscard]] bool is_binary() const;

 private:
  // Division by ten keeps three codes of 0.1 m equal to 0.3 m; multiplication by 0.1 does not.
  double factor_ = 1, divisor_ = 1;
};

/// Height codes in the narrowest type that holds every one of them: int16 whole numbers, float, double.
using Codes = std::variant<std::vector<std::int16_t>, std::vector<float>, std::vector<double>>;
using CodeSpan = std::variant<std::span<const std::int16_t>, std::span<const float>, std::span<const double>>;

/// Height codes over an extent, row by row. Codes are whole numbers in a height step or the source's
/// own floats.
struct HeightField {
  GridRect extent;
  std::span<const double> heights;      ///< samples() of them; void vertices hold their fill
  std::span<const std::uint8_t> valid;  ///< 1 where a sample is data; empty: all are
  CodeDistance distance;
  /// Every interpolation the errors need is exact in double; otherwise errors carry kRoundingMargin.
  bool exact = true;
  /// All heights are whole numbers: kernels may use float where the range allows it.
  bool whole_numbers = true;

  [[nodiscard]] std::size_t index(GridPoint p) const {
    return static_cast<std::size_t>((std::int64_t{p.row} - extent.first.row) * extent.cols() +
                                    (std::int64_t{p.col} - extent.first.col));
  }
  [[nodiscard]] double operator[](GridPoint p) const { return heights[index(p)]; }
};

/// Metres added to a computed error where arithmetic rounds: heights reach 10⁶ m, one evaluation takes
/// six roundings of at most 2⁻⁵³ of a few times that.
inline constexpr double kRoundingMargin = 4e-9;

/// True if every dyadic interpolation over triangles up to `side` cells is exact in double: the heights
/// are multiples of a power of two fine and small enough. Linear time.
[[nodiscard]] bool interpolation_is_exact(std::span<const double> heights, std::int32_t side);
[[nodiscard]] bool are_whole_numbers(std::span<const double> heights);

}  // namespace talus
