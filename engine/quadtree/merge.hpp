#pragma once
// Two sets of vertices with heights and covers become one.

#include <span>

#include "talus/increment.hpp"

namespace talus {

/// Everything of `added` but its vertices, heights and covers, which are those of both: of `kept` those that lie in the
/// region of `added` and are not `gone`. No vertex may be in both.
///
/// fails  invalid_argument: a vertex in both, or more or fewer heights or covers than vertices
[[nodiscard]] RestrictedQuadtree united(const RestrictedQuadtree& kept, std::span<const GridPoint> gone,
                                        const RestrictedQuadtree& added);

/// fails  invalid_argument: an increment that does not go on from this answer
void require_fit(const RestrictedQuadtree& answer, const Increment& increment);

}  // namespace talus
