#include "engine/error/error_rule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/error/vertex_error.hpp"

namespace talus {

double ErrorRule::share(const HalfDiamond& half, const Plane<double>& codes, const CodeDistance& distance) const {
  if (metric == ErrorMetric::vertical) return 1;
  const CellSize size = cell(half.vertex.row);
  const auto slope = [&](double rise, double run) {
    if (rise == 0) return 0.0;
    return run > 0 ? distance.metres(std::abs(rise)) / run : std::numeric_limits<double>::infinity();  // at a pole
  };
  const double stretch = std::hypot(std::hypot(1, slope(codes.right, size.width)), slope(codes.down, size.height));
  constexpr double kRoundedUp = 1 + 8 * std::numeric_limits<double>::epsilon();
  return std::min(1.0, kRoundedUp / stretch);
}

ErrorCode ErrorRule::over(ErrorCode own, ErrorCode below) const {
  if (kind != ErrorKind::nested || own == 0 || below == 0) return std::max(own, below);
  const double a = error_of(own), b = error_of(below), sum = a + b;
  return error_code(halves_exactly(a, b, sum / 2) ? sum : std::nextafter(sum, std::numeric_limits<double>::infinity()));
}

namespace {

constexpr std::array<const char*, 3> kKinds{"exact", "nested", "midpoint"};
constexpr std::array<const char*, 2> kMetrics{"vertical", "perpendicular"};

template <class Named, std::size_t n>
std::optional<Named> find(const std::array<const char*, n>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Named>(found - names.begin());
}

}  // namespace

const char* name_of(ErrorKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }
const char* name_of(ErrorMetric metric) { return kMetrics[static_cast<std::size_t>(metric)]; }
std::optional<ErrorKind> error_kind_named(std::string_view name) { return find<ErrorKind>(kKinds, name); }
std::optional<ErrorMetric> error_metric_named(std::string_view name) { return find<ErrorMetric>(kMetrics, name); }

}  // namespace talus
