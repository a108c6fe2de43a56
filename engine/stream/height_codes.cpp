#include "engine/stream/height_codes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "talus/failure.hpp"

namespace talus {
namespace {

/// The bits of a float, changed so that they rise with the values.
std::int32_t ordered(float v) {
  const auto bits = std::bit_cast<std::int32_t>(v);
  return bits ^ ((bits >> 31) & 0x7fffffff);
}
float from_ordered(std::int32_t v) { return std::bit_cast<float>(v ^ ((v >> 31) & 0x7fffffff)); }
std::int64_t ordered(double v) {
  const auto bits = std::bit_cast<std::int64_t>(v);
  return bits ^ ((bits >> 63) & std::numeric_limits<std::int64_t>::max());
}
double from_ordered(std::int64_t v) {
  return std::bit_cast<double>(v ^ ((v >> 63) & std::numeric_limits<std::int64_t>::max()));
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

/// The nearest whole number, for |v| up to 2^51. Beyond, neighbouring doubles are more than a half apart.
double nearest(double v) {
  constexpr double kShift = 6755399441055744.0;  // 3 · 2^51
  return (v + kShift) - kShift;
}

/// Computes the whole number of a height. Returns false if the step does not restore the height from it, bit for bit.
bool whole_code(const HeightStep& step, double height, double& code) {
  code = nearest((height - step.offset) * step.divisor / step.scale) + 0.0;  // + 0.0: no negative zero
  return std::abs(code) < 2e15 && same_bits(step.value(code), height);
}

constexpr double kMostNarrow = 1 << 30;

double tolerance_in_codes(CodeKind kind, const Description& d, const HeightStep& step, Metres tolerance) {
  if (kind == CodeKind::whole || kind == CodeKind::quanta)
    return tolerance.value / d.metres_per_unit / std::abs(step.scale) * step.divisor;
  const double largest = std::max({std::abs(d.minimum_height), std::abs(d.maximum_height), 1e-30});
  return std::ldexp(tolerance.value / d.metres_per_unit, (kind == CodeKind::floats ? 23 : 52) - std::ilogb(largest));
}

/// The step of codes. Without a height step in the database it is 1: whole numbers are their own codes.
HeightStep step_of(CodeKind kind, const Description& d, Metres quantum) {
  if (kind != CodeKind::quanta) return d.step.integer ? d.step : HeightStep{};
  HeightStep step;
  step.scale = quantum.value / d.metres_per_unit;
  return step;
}

}  // namespace

HeightCoding HeightCoding::of(const Description& d, Metres quantum, Metres tolerance,
                              std::span<const std::span<const double>> heights) {
  HeightCoding coding;
  coding.kind = quantum.value > 0 ? CodeKind::quanta : CodeKind::whole;
  coding.step = step_of(coding.kind, d, quantum);
  double largest = 0, code = 0;
  const auto all = [&](auto&& fits) {
    return std::ranges::all_of(heights, [&](std::span<const double> some) {
      return std::ranges::all_of(some, [&](double h) {
        if (!std::isfinite(h)) throw Failure(Cause::invalid_argument, "cannot write a height that is infinite or NaN");
        return fits(h);
      });
    });
  };
  const bool are_whole = all([&](double h) {
    if (!whole_code(coding.step, h, code)) return false;
    largest = std::max(largest, std::abs(code));
    return true;
  });
  if (!are_whole) {
    if (coding.kind == CodeKind::quanta)
      throw Failure(Cause::invalid_argument, "cannot write a height between two multiples of the quantum");
    const bool are_floats = all([](double h) { return same_bits(static_cast<double>(static_cast<float>(h)), h); });
    coding.kind = are_floats ? CodeKind::floats : CodeKind::doubles;
    largest = 0;
  }
  coding.is_wide = coding.kind == CodeKind::doubles || largest >= kMostNarrow;
  coding.tolerance = tolerance_in_codes(coding.kind, d, coding.step, tolerance);
  return coding;
}

HeightCoding HeightCoding::of(const StreamHeader& h) {
  HeightCoding coding;
  coding.kind = h.kind;
  coding.is_wide = h.is_wide;
  coding.step = step_of(h.kind, h.description, h.quadtree.origin.quantum);
  coding.tolerance = tolerance_in_codes(h.kind, h.description, coding.step, h.quadtree.tolerance);
  return coding;
}

template <class Code>
std::optional<Array<Code>> codes_of(const HeightCoding& coding, std::span<const double> heights) {
  Array<Code> codes(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (coding.kind == CodeKind::floats) {
      const auto narrow = static_cast<float>(heights[i]);
      if (!same_bits(static_cast<double>(narrow), heights[i])) return std::nullopt;
      codes[i] = ordered(narrow);
    } else if (coding.kind == CodeKind::doubles) {
      if constexpr (sizeof(Code) < 8) return std::nullopt;
      codes[i] = static_cast<Code>(ordered(heights[i]));
    } else {
      double code = 0;
      if (!whole_code(coding.step, heights[i], code) || (sizeof(Code) < 8 && std::abs(code) >= kMostNarrow))
        return std::nullopt;
      codes[i] = static_cast<Code>(code);
    }
  }
  return codes;
}

template <class Code>
Array<double> heights_of(const HeightCoding& coding, std::span<const Code> codes) {
  Array<double> heights(codes.size());
  bool finite = true;
  if (coding.kind == CodeKind::floats) {
    for (std::size_t i = 0; i < codes.size(); ++i) heights[i] = from_ordered(static_cast<std::int32_t>(codes[i]));
  } else if (coding.kind == CodeKind::doubles) {
    for (std::size_t i = 0; i < codes.size(); ++i) heights[i] = from_ordered(static_cast<std::int64_t>(codes[i]));
  } else if (coding.step.scale == 1 && coding.step.divisor == 1 && coding.step.offset == 0) {
    for (std::size_t i = 0; i < codes.size(); ++i) heights[i] = static_cast<double>(codes[i]);
  } else {
    const HeightStep step = coding.step;
    for (std::size_t i = 0; i < codes.size(); ++i)
      heights[i] = static_cast<double>(codes[i]) * step.scale / step.divisor + step.offset;
  }
  for (const double h : heights) finite &= std::abs(h) <= std::numeric_limits<double>::max();
  if (!finite) throw Failure(Cause::corrupt, "corrupt: a height is infinite or NaN");
  return heights;
}

template std::optional<Array<std::int32_t>> codes_of(const HeightCoding&, std::span<const double>);
template std::optional<Array<std::int64_t>> codes_of(const HeightCoding&, std::span<const double>);
template Array<double> heights_of(const HeightCoding&, std::span<const std::int32_t>);
template Array<double> heights_of(const HeightCoding&, std::span<const std::int64_t>);

}  // namespace talus
