#pragma once
// The heights of a rectangle for the computation of errors.

#include <cstdint>
#include <limits>
#include <span>
#include <variant>
#include <vector>

#include "engine/error/error_ladder.hpp"
#include "engine/quadtree/rect.hpp"
#include "talus/description.hpp"
#include "talus/units.hpp"

namespace talus {

/// Height codes in the narrowest type that holds the source's numbers: whole numbers of 16 bits; Float32 numbers and
/// whole numbers within 2²⁴; all others.
using Codes = std::variant<std::vector<std::int16_t>, std::vector<float>, std::vector<double>>;
using CodeSpan = std::variant<std::span<const std::int16_t>, std::span<const float>, std::span<const double>>;

[[nodiscard]] CodeSpan view(const Codes& codes);
[[nodiscard]] inline double code_at(const CodeSpan& codes, std::size_t i) {
  return std::visit([&](auto c) { return static_cast<double>(c[i]); }, codes);
}

inline void set_code(Codes& codes, std::size_t i, double code) {
  std::visit([&](auto& all) { all[i] = static_cast<typename std::decay_t<decltype(all)>::value_type>(code); }, codes);
}

/// Errors of so many eighths of a height code do not count in eighths.
inline constexpr std::int32_t kMostEighths = std::numeric_limits<std::int32_t>::max();

/// Converts a distance in height codes to metres.
class CodeDistance {
 public:
  CodeDistance() = default;
  CodeDistance(const HeightStep& step, double metres_per_unit);
  /// Of a database.
  explicit CodeDistance(const Description& description);
  [[nodiscard]] double metres(double codes) const { return codes * factor_ / divisor_; }
  [[nodiscard]] double factor() const { return factor_; }
  [[nodiscard]] double divisor() const { return divisor_; }
  /// Whether all height codes of the database are whole numbers, and all samples were kept: errors are then whole
  /// eighths of a code.
  [[nodiscard]] bool is_whole() const { return is_whole_; }
  /// The fewest eighths of a height code that are not below an error in metres; kMostEighths if it takes so many.
  [[nodiscard]] std::int32_t eighths(double metres) const;
  /// What a stored error counts as: these eighths, or, if height codes are not whole, the code.
  [[nodiscard]] std::int32_t counted(ErrorCode code) const { return is_whole_ ? eighths(error_of(code)) : code; }
  /// What a tolerance of at least 0 metres counts as: the most eighths within it (kMostEighths if so many are), or, if
  /// height codes are not whole, the largest error code within it.
  [[nodiscard]] std::int32_t counted_within(double metres) const;
  /// The error of a code in metres; if height codes are whole, rounded up to eighths of one. An error of kMostEighths
  /// stays as it is.
  [[nodiscard]] double up_to_eighths(ErrorCode code) const;
  friend bool operator==(const CodeDistance&, const CodeDistance&) = default;
  /// Whether one code is a power of two in metres, so that no conversion rounds.
  [[nodiscard]] bool is_binary() const;

 private:
  // Division by ten makes three codes of 0.1 m equal to 0.3 m; multiplication by 0.1 does not.
  double factor_ = 1, divisor_ = 1;
  bool is_whole_ = false;
};

/// Height codes over an extent, row by row. A code is a whole number of height steps, or the source's own float.
struct HeightField {
  GridRect extent;
  CodeSpan heights;                     ///< one a sample; void vertices hold their fill
  std::span<const std::uint8_t> valid;  ///< 1: valid, 0: void; empty: all are valid
  CodeDistance distance;

  [[nodiscard]] std::size_t index(GridPoint p) const { return index_in(extent, p); }
  [[nodiscard]] double operator[](GridPoint p) const { return code_at(heights, index(p)); }
  [[nodiscard]] bool is_valid(std::size_t i) const { return valid.empty() || valid[i] != 0; }
};

/// Metres added to an error where arithmetic rounds: heights reach 10⁶ m, and an evaluation has six roundings of at
/// most 2⁻⁵³ of a few times that.
inline constexpr double kRoundingMargin = 4e-9;

/// The bits that a set of numbers uses: exponents of the lowest and of the highest one. Empty set: no bits.
struct BitRange {
  static constexpr std::int16_t kNone = 1100;
  std::int16_t finest = kNone, coarsest = -kNone;

  void take(double h);
  void take(const BitRange& other);
  /// Whether every dyadic interpolation over triangles of up to `side` cells is exact in double.
  [[nodiscard]] bool interpolates_exactly(std::int32_t side) const;
  friend bool operator==(const BitRange&, const BitRange&) = default;
};

}  // namespace talus
