#include "query/selection/threshold.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace talus {
namespace {

/// Metres; more than doubles round decimal heights by. Part of the bound, unless the step is a binary fraction.
constexpr double kDecimalRounding = 1e-9;

/// The largest distance in height codes that is still within a tolerance of at least 0.
double largest_distance_within(double tolerance_m, const CodeDistance& distance) {
  const auto within = [&](double codes) { return distance.metres(codes) <= tolerance_m; };
  // `high` is finite in metres, too
  double low = 0, high = std::numeric_limits<double>::max() / std::max(1.0, distance.factor());
  if (within(high)) return high;
  const auto look = [&](double at) {
    if (at > low && at < high) (within(at) ? low : high) = at;
  };
  const double near =
      tolerance_m / distance.metres(1);  // the answer but for a few roundings, or for more where these underflow
  look(near * (1 - 1e-15));
  look(near * (1 + 1e-15));
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return low;
    look(middle);
  }
}

/// A distance in height codes as eighths of a code, rounded down.
std::int32_t largest_eighths_within(double largest_distance) {
  return largest_distance < kMostEighths / 8 ? static_cast<std::int32_t>(largest_distance * 8) : kMostEighths;
}

double error_of_absent(const StoredPages& pages, const LargestAbsent& absent, double tolerance_m) {
  const Description& d = pages.manifest().description;
  double metres = std::max(std::min(tolerance_m, pages.distance().up_to_eighths(absent.code)), d.kept_above().value);
  if (absent.distance >= 0) metres = std::max(metres, std::min(tolerance_m, pages.distance().metres(absent.distance)));
  const bool heights_are_exact = pages.distance().is_binary() && d.step.offset == 0 && d.finest_tolerance.value == 0;
  return metres + d.lossy.value + (heights_are_exact ? 0 : kDecimalRounding);
}

}  // namespace

Threshold::Threshold(double tolerance_m, const CodeDistance& distance) : code_(largest_code_within(tolerance_m)) {
  if (tolerance_m < 0) return;
  counted_ = distance.counted_within(tolerance_m);
  if (distance.is_whole() && counted_ < kMostEighths) {
    eighths_ = counted_;
    distance_ = eighths_ / 8.0;
    code_ = largest_code_within(distance.metres(distance_));
  } else {
    distance_ = largest_distance_within(distance.is_whole() ? tolerance_m : error_of(code_), distance);
    eighths_ = largest_eighths_within(distance_);
  }
}

LargestByLevel::LargestByLevel(GridRect extent)
    : levels_(static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(root_side(extent)))) + 1) {}

void LargestByLevel::take(const LargestByLevel& others) {
  for (std::size_t i = 0; i < levels_.size(); ++i) levels_[i].take(others.levels_[i]);
}

std::vector<double> LargestByLevel::metres(const StoredPages& pages) const {
  std::vector<double> metres;
  for (const LargestAbsent& level : levels_) {
    const bool is_empty = level.code == 0 && level.distance < 0;
    metres.push_back(is_empty ? 0 : error_of_absent(pages, level, std::numeric_limits<double>::infinity()));
  }
  return metres;
}

Metres bound_of(const StoredPages& pages, const LargestAbsent& absent, double tolerance_m) {
  return Metres{error_of_absent(pages, absent, tolerance_m)};
}

}  // namespace talus
