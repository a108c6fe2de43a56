#include "engine/error/height_field.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace talus {

CodeSpan view(const Codes& codes) {
  return std::visit([](const auto& c) { return CodeSpan(std::span(c)); }, codes);
}

CodeDistance::CodeDistance(const HeightStep& step, double metres_per_unit) {
  const double scale = std::abs(step.scale), per_unit = std::round(1 / scale);
  const bool is_fraction = scale < 1 && std::abs(scale * per_unit - 1) < 3e-16;  // scale is the double nearest to 1/n
  factor_ = (is_fraction ? 1 : scale) * metres_per_unit;
  divisor_ = step.divisor * (is_fraction ? per_unit : 1);
  is_whole_ = step.integer;
}

CodeDistance::CodeDistance(const Description& description)
    : CodeDistance(description.step, description.metres_per_unit) {
  // Which vertices were dropped was decided by rungs of the ladder.
  is_whole_ = is_whole_ && description.finest_tolerance.value == 0;
}

std::int32_t CodeDistance::eighths(double metres) const {
  const auto is_below = [&](double eighths) { return this->metres(eighths / 8) < metres; };
  double eighths = std::ceil(metres * divisor_ / factor_ * 8);
  if (!(eighths <= kMostEighths)) return kMostEighths;  // a double holds each whole number up to there
  while (eighths > 0 && !is_below(eighths - 1)) --eighths;
  while (is_below(eighths)) ++eighths;
  return static_cast<std::int32_t>(std::min(eighths, double{kMostEighths}));
}

std::int32_t CodeDistance::counted_within(double metres) const {
  if (!is_whole_) return largest_code_within(metres);
  const std::int32_t enough = eighths(metres);
  return enough == kMostEighths || this->metres(enough / 8.0) <= metres ? enough : enough - 1;
}

double CodeDistance::up_to_eighths(ErrorCode code) const {
  const double error = error_of(code);
  if (!is_whole_ || code == 0 || code >= kAlwaysSelected) return error;
  const std::int32_t counted = eighths(error);
  return counted == kMostEighths ? error : std::max(error, metres(counted / 8.0));
}

bool CodeDistance::is_binary() const {
  int unused = 0;
  return std::frexp(factor_, &unused) == 0.5 && std::frexp(divisor_, &unused) == 0.5;
}

void BitRange::take(double h) {
  if (h == 0) return;
  const auto bits = std::bit_cast<std::uint64_t>(h);
  const int exponent = static_cast<int>(bits >> 52 & 0x7ff);
  if (exponent == 0 || exponent == 0x7ff) {  // denormal: use the margin
    *this = {-kNone, kNone};
    return;
  }
  const std::uint64_t mantissa = (bits & ((std::uint64_t{1} << 52) - 1)) | std::uint64_t{1} << 52;
  finest = std::min(finest, static_cast<std::int16_t>(exponent - 1075 + std::countr_zero(mantissa)));
  coarsest = std::max(coarsest, static_cast<std::int16_t>(exponent - 1023));
}

void BitRange::take(const BitRange& other) {
  finest = std::min(finest, other.finest);
  coarsest = std::max(coarsest, other.coarsest);
}

bool BitRange::interpolates_exactly(std::int32_t side) const {
  // Sums and differences of up to three terms need two more bits above, division by the side log2(side) more below.
  const int below = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(side))) + 1;
  return finest > coarsest || coarsest + 3 - (finest - below) <= 53;
}

}  // namespace talus
