#include "ingest/height_step.hpp"

#include <bit>
#include <cmath>

namespace talus {
namespace {

bool is_restored(double value, double divisor) {
  const double back = std::nearbyint(value * divisor) / divisor;
  // Bits, so that -0.0 is not mistaken for 0.
  return std::bit_cast<std::uint64_t>(back + 0.0) == std::bit_cast<std::uint64_t>(value);
}

}  // namespace

HeightStep find_height_step(const Description& source, std::vector<double>& codes,
                            const std::vector<std::uint8_t>& valid) {
  if (source.step.integer) return source.step;
  for (const double divisor : {1.0, 10.0, 100.0, 1000.0}) {
    if (divisor > 1 && source.source_type != "Float64") break;
    bool all = true;
    for (std::size_t i = 0; all && i < codes.size(); ++i) all = !valid[i] || is_restored(codes[i], divisor);
    if (!all) continue;
    for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = valid[i] ? std::nearbyint(codes[i] * divisor) + 0.0 : 0;
    return {1, divisor, 0, true};
  }
  return source.step;
}

}  // namespace talus
