#pragma once
// What an answer lacks of a finer one, and how the two become one.

#include "talus/cost.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// The vertices whose errors lie above one tolerance and within another. What the region's border needs whatever the
/// tolerance is none of them: it came with the first answer.
///
/// `added` has everything of an answer at the finer tolerance but its other vertices: region, tolerance, bound, origin.
/// Its vertices alone are not closed under their parents; they are once merged.
struct Increment {
  RestrictedQuadtree added;
  Metres from;     ///< of the answer that it goes on from; added.tolerance is below it
  QueryCost cost;  ///< of asking; no part of its serialised form
};

/// The answer at the increment's tolerance, bit for bit as Snapshot::ask gives it: vertices, heights, covers,
/// tolerance, bound and origin. Chains of any length come out the same.
///
/// answer      at the tolerance that the increment goes on from, of the same region and the same state of the same
///             database; asked with nothing but a region and a tolerance, or merged from such
/// fails       invalid_argument: any other
/// cost        linear in both, and a bit a sample of the region
[[nodiscard]] RestrictedQuadtree merge(const RestrictedQuadtree& answer, const Increment& increment);

}  // namespace talus
