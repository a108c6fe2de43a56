#pragma once
// Heights of a rectangle as the error computation sees them.

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "engine/quadtree/rect.hpp"
#include "talus/description.hpp"
#include "talus/units.hpp"

namespace talus {

/// Height codes in the narrowest type that holds the source's numbers: whole numbers in 16 bits, the numbers
/// of a Float32 source and whole numbers within 2²⁴, all others.
using Codes = std::variant<std::vector<std::int16_t>, std::vector<float>, std::vector<double>>;
using CodeSpan = std::variant<std::span<const std::int16_t>, std::span<const float>, std::span<const double>>;

[[nodiscard]] CodeSpan view(const Codes& codes);
[[nodiscard]] inline double code_at(const CodeSpan& codes, std::size_t i) {
  return std::visit([&](auto c) { return static_cast<double>(c[i]); }, codes);
}

/// From a distance in height codes to metres.
class CodeDistance {
 public:
  CodeDistance() = default;
  CodeDistance(const HeightStep& step, double metres_per_unit);
  [[nodiscard]] double metres(double codes) const { return codes * factor_ / divisor_; }
  [[nodiscard]] double factor() const { return factor_; }
  [[nodiscard]] double divisor() const { return divisor_; }
  friend bool operator==(const CodeDistance&, const CodeDistance&) = default;
  /// Metres are a whole power of two of codes: no conversion rounds.
  [[nodiscard]] bool is_binary() const;

 private:
  // Division by ten keeps three codes of 0.1 m equal to 0.3 m; multiplication by 0.1 does not.
  double factor_ = 1, divisor_ = 1;
};

/// Height codes over an extent, row by row. Codes are whole numbers in a height step or the source's
/// own floats.
struct HeightField {
  GridRect extent;
  CodeSpan heights;                     ///< samples() of them; void vertices hold their fill
  std::span<const std::uint8_t> valid;  ///< 1 where a sample is data; empty: all are
  CodeDistance distance;

  [[nodiscard]] std::size_t index(GridPoint p) const { return index_in(extent, p); }
  [[nodiscard]] double operator[](GridPoint p) const { return code_at(heights, index(p)); }
  [[nodiscard]] bool is_valid(std::size_t i) const { return valid.empty() || valid[i] != 0; }
};

/// Metres added to a computed error where arithmetic rounds: heights reach 10⁶ m, one evaluation takes
/// six roundings of at most 2⁻⁵³ of a few times that.
inline constexpr double kRoundingMargin = 4e-9;

/// The bits that a set of numbers uses: exponents of the lowest and of the highest. No number: none.
struct BitRange {
  static constexpr std::int16_t kNone = 1100;
  std::int16_t finest = kNone, coarsest = -kNone;

  void take(double h);
  void take(const BitRange& other);
  /// True if every dyadic interpolation between such numbers over triangles up to `side` cells is exact in
  /// double: they are multiples of a power of two fine and small enough.
  [[nodiscard]] bool interpolates_exactly(std::int32_t side) const;
  friend bool operator==(const BitRange&, const BitRange&) = default;
};

}  // namespace talus
