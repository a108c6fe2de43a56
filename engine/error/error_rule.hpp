#pragma once
// What the error of a vertex is: the samples it tells of, the direction it is measured in, and what is made of it and
// the errors of its children.

#include <functional>

#include "engine/error/error_ladder.hpp"
#include "engine/error/height_field.hpp"
#include "engine/geo/geodesy.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "talus/description.hpp"

namespace talus {

struct ErrorRule {
  ErrorKind kind = ErrorKind::exact;
  ErrorMetric metric = ErrorMetric::vertical;
  std::function<CellSize(std::int32_t row)> cell = {};  ///< needed by the perpendicular metric only

  /// What the kernels compute, and pages imply.
  [[nodiscard]] bool is_usual() const { return kind == ErrorKind::exact && metric == ErrorMetric::vertical; }
  /// Errors tell of every sample of a diamond; otherwise of its vertex and the ends of its side.
  [[nodiscard]] bool measures_samples() const { return kind == ErrorKind::exact; }

  /// What a distance along the vertical is to be multiplied by: 1, or the cosine of a half's tilt, rounded up.
  [[nodiscard]] double share(const HalfDiamond& half, const Plane<double>& codes, const CodeDistance& distance) const;

  /// Of a vertex with an error of its own, the largest of whose children is `below`: not smaller than either.
  [[nodiscard]] ErrorCode over(ErrorCode own, ErrorCode below) const;
};

}  // namespace talus
