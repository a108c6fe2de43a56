#pragma once
// An answer in the order in which it becomes visible: ever finer quadtrees, each whole and with a bound of its own.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "talus/quadtree.hpp"

namespace talus {

/// Takes an answer apart, level by level. Step 0 holds what the region's border needs, at whatever spacing, and root
/// corners: with it alone the region is covered. Step k holds the other vertices of level k - 1. The vertices of the
/// first steps are a restricted quadtree, and their bound is what its triangles keep.
///
/// The first steps of what an increment adds are an increment, too, by which the answer becomes such a quadtree;
/// nothing more can be merged into it. Threads: several may look at one at once.
class Progression {
 public:
  /// answer   its border constrained; it may go afterwards. Or what an increment adds.
  /// errors   by rank, see errors_of: orders the vertices of a step, the largest error first, and parents before
  ///          their children, so that a quadtree may end anywhere in a step. Empty: row by row.
  /// fails    invalid_argument: another border, whose answers have no coarser ones in them; another number of errors
  explicit Progression(const RestrictedQuadtree& answer, std::span<const double> errors = {});

  [[nodiscard]] std::size_t steps() const { return steps_.size(); }
  /// log2 of the spacing of a step's vertices; of step 0 that of the root square's side.
  [[nodiscard]] int shift(std::size_t step) const { return static_cast<int>(steps_.size() - 1 - step); }
  /// The ranks in the answer of a step's vertices, in order.
  [[nodiscard]] std::span<const std::uint32_t> ranks(std::size_t step) const;
  [[nodiscard]] std::span<const GridPoint> points(std::size_t step) const;
  /// No sample under the surface of this and all earlier steps is farther from it. Infinity: not known, because the
  /// answer varies (RestrictedQuadtree::level_errors).
  [[nodiscard]] Metres bound(std::size_t step) const { return steps_[step].bound; }

  /// The quadtree of the first steps, and of the first `more` vertices of the step after them: a closed set if these
  /// are ordered by errors. Its tolerance is the answer's; increments do not fit it unless it is all of the answer.
  /// fails  invalid_argument: fewer steps or vertices than that
  [[nodiscard]] RestrictedQuadtree prefix(const RestrictedQuadtree& answer, std::size_t steps,
                                          std::size_t more = 0) const;

 private:
  struct Step {
    std::size_t begin = 0, end = 0;
    Metres bound;
  };
  std::vector<Step> steps_;
  std::vector<std::uint32_t> ranks_;
  std::vector<GridPoint> points_;
};

}  // namespace talus
