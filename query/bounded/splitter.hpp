#pragma once
// Splits triangles until every sample lies within a tolerance, for any heights of the corners.

#include "query/bounded/bounded_heights.hpp"

namespace talus {

/// Rounding to multiples of a quantum.
class Rounding {
 public:
  Rounding(const Description& d, Metres quantum) : unit_(quantum.value / d.metres_per_unit) {}
  [[nodiscard]] double operator()(double height) const;
  [[nodiscard]] double unit() const { return unit_; }
  /// Whether multiples, and heights interpolated between them, are exact doubles.
  [[nodiscard]] bool is_exact() const;

 private:
  double unit_;
};

enum class SplitHeights {
  rounded,  ///< the source's heights, rounded
  fitted,   ///< moved within the tolerance so that most triangles stay, then rounded
};

/// Compares every sample of a region with triangles between rounded heights, and splits these until every sample is
/// within the tolerance. On the region's sides, vertices and heights are those of the exact answer at the tolerance
/// minus the rounding, rounded.
///
/// quantum  above 0, see require_quantum
/// returns  an answer with a measured bound; the caller sets `tolerance` and quantum
/// cost     memory: 9 bytes a sample of the region, 26 if fitted. Time: a few passes over the samples, about fifty if
///          fitted
/// source   fitted heights: relaxation of linear inequalities, Agmon 1954, Motzkin and Schoenberg 1954
[[nodiscard]] Answer split_answer(const RoundedQuestion& question, Metres quantum, SplitHeights heights);

}  // namespace talus
