#pragma once
// The direction that a vertex's error is measured in, and what a distance along the vertical is worth there.

#include <functional>

#include "engine/error/height_field.hpp"
#include "engine/geo/ground_scale.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "talus/description.hpp"

namespace talus {

struct ErrorRule {
  ErrorMetric metric = ErrorMetric::vertical;
  std::function<CellSize(std::int32_t row)> cell = {};  ///< needed by the perpendicular metric only

  /// What the kernels compute, and pages imply.
  [[nodiscard]] bool is_vertical() const { return metric == ErrorMetric::vertical; }

  /// What a distance along the vertical is to be multiplied by: 1, or the cosine of a half's tilt, rounded up.
  [[nodiscard]] double share(const HalfDiamond& half, const Plane<double>& codes, const CodeDistance& distance) const;
};

}  // namespace talus
