#pragma once
// The increment between two tolerances, and how to merge it.

#include "talus/cost.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// The vertices with an error above one tolerance (`from`) and within a finer one. It has no vertices that the region's
/// border needs at every tolerance: the first answer has them.
///
/// `added` has the region, tolerance, bound and origin of the finer answer, but only the new vertices. They become a
/// closed set (each vertex with its parents) when merged.
struct Increment {
  RestrictedQuadtree added;
  Metres from;     ///< tolerance of the coarser answer, above added.tolerance
  QueryCost cost;  ///< cost of the question; streams do not store it
};

/// The answer at the finer tolerance, equal to Snapshot::ask bit for bit: vertices, heights, covers, tolerance, bound
/// and origin. Increments can be merged one after another.
///
/// answer      the answer at `increment.from` for the same region and the same state of the database. Its question had
///             a region and a tolerance only; or it was merged from such an answer
/// fails       invalid_argument: the answer is another one
/// cost        linear in both, plus one bit a sample of the region
[[nodiscard]] RestrictedQuadtree merge(const RestrictedQuadtree& answer, const Increment& increment);

}  // namespace talus
