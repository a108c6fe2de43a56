#pragma once
// An answer as a sequence of ever finer quadtrees, each complete and with its own bound.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "talus/quadtree.hpp"

namespace talus {

/// Divides an answer into steps. Step 0 has what the region's border needs, and root corners: they fill the region.
/// Step k has the other vertices of level k - 1. The first steps together are a restricted quadtree with its own bound.
///
/// The first steps of an increment are an increment too. It leads to such a quadtree; nothing more can be merged into
/// that. Threads: any number may read one at once.
class Progression {
 public:
  /// answer   an answer with a constrained border, or Increment::added; it may be destroyed afterwards
  /// errors   by rank, see errors_of: sorts the vertices of a step by falling error, parents before children, so that a
  ///          quadtree can end anywhere in a step. Empty: row by row
  /// fails    invalid_argument: another border; not one error a vertex
  explicit Progression(const RestrictedQuadtree& answer, std::span<const double> errors = {});

  [[nodiscard]] std::size_t steps() const { return steps_.size(); }
  /// log2 of the spacing of a step's vertices; for step 0, of the root square's side.
  [[nodiscard]] int shift(std::size_t step) const { return static_cast<int>(steps_.size() - 1 - step); }
  /// The vertices of a step in order, as ranks in the answer.
  [[nodiscard]] std::span<const std::uint32_t> ranks(std::size_t step) const;
  [[nodiscard]] std::span<const GridPoint> points(std::size_t step) const;
  /// The bound of steps 0 to `step` together. Infinity: not known, because the tolerance varies
  /// (RestrictedQuadtree::level_errors).
  [[nodiscard]] Metres bound(std::size_t step) const { return steps_[step].bound; }

  /// The quadtree of the first `steps` steps and the first `more` vertices of the next one (`more` > 0 needs `errors`).
  /// Its tolerance is the answer's. Increments can follow only if it is the whole answer.
  /// fails  invalid_argument: the answer has fewer steps or vertices
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
