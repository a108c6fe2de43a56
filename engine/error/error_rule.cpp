#include "engine/error/error_rule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace talus {

double ErrorRule::share(const HalfDiamond& half, const Plane<double>& codes, const CodeDistance& distance) const {
  if (is_vertical()) return 1;
  const CellSize size = cell(half.vertex.row);
  const auto slope = [&](double rise, double run) {
    if (rise == 0) return 0.0;
    return run > 0 ? distance.metres(std::abs(rise)) / run : std::numeric_limits<double>::infinity();  // at a pole
  };
  const double stretch = std::hypot(std::hypot(1, slope(codes.right, size.width)), slope(codes.down, size.height));
  constexpr double kRoundedUp = 1 + 8 * std::numeric_limits<double>::epsilon();
  return std::min(1.0, kRoundedUp / stretch);
}

namespace {

constexpr std::array<const char*, 2> kMetrics{"vertical", "perpendicular"};

}  // namespace

const char* name_of(ErrorMetric metric) { return kMetrics[static_cast<std::size_t>(metric)]; }
std::optional<ErrorMetric> error_metric_named(std::string_view name) {
  const auto found = std::find(kMetrics.begin(), kMetrics.end(), name);
  if (found == kMetrics.end()) return std::nullopt;
  return static_cast<ErrorMetric>(found - kMetrics.begin());
}

}  // namespace talus
