#pragma once
// The direction in which errors are measured, and the factor from vertical distances to distances in this direction.

#include <functional>

#include "engine/error/height_field.hpp"
#include "engine/geo/ground_scale.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "talus/description.hpp"

namespace talus {

struct ErrorRule {
  ErrorMetric metric = ErrorMetric::vertical;
  std::function<CellSize(std::int32_t row)> cell = {};  ///< for the perpendicular metric only

  /// Only vertical errors are computed by kernels and implied by pages.
  [[nodiscard]] bool is_vertical() const { return metric == ErrorMetric::vertical; }

  /// The factor from a vertical distance to an error: 1, or the cosine of the half-diamond's tilt, rounded up.
  [[nodiscard]] double share(const HalfDiamond& half, const Plane<double>& codes, const CodeDistance& distance) const;
};

}  // namespace talus
