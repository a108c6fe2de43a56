#pragma once
// Triangles split until every sample lies within a tolerance of them, whatever heights their corners have.

#include "query/bounded/bounded_heights.hpp"

namespace talus {

/// Multiples of a quantum.
class Rounding {
 public:
  Rounding(const Description& d, Metres quantum) : unit_(quantum.value / d.metres_per_unit) {}
  [[nodiscard]] double operator()(double height) const;
  [[nodiscard]] double unit() const { return unit_; }
  /// Whether multiples, and what is interpolated between them, are doubles.
  [[nodiscard]] bool is_exact() const;

 private:
  double unit_;
};

enum class SplitHeights {
  rounded,  ///< the source's, rounded
  fitted,   ///< wherever within the tolerance of the source's they let most triangles stay, rounded
};

/// Every sample of a region held against triangles between rounded heights, which are split until none is farther than
/// the tolerance. On the region's sides vertices and heights are those of the exact answer at the tolerance less the
/// rounding, rounded.
///
/// quantum  above 0, see require_quantum
/// returns  its bound is measured; `tolerance` and quantum are the caller's to say
/// cost     memory 9 bytes a sample of the region, fitted 26. Time: a few passes over the samples, fitted some fifty
/// source   fitted heights: relaxation of linear inequalities, Agmon 1954, Motzkin and Schoenberg 1954
[[nodiscard]] Answer split_answer(const RoundedQuestion& question, Metres quantum, SplitHeights heights);

}  // namespace talus
