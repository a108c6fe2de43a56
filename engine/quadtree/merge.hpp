#pragma once
// Joins two sets of vertices with their heights and covers.

#include <span>

#include "talus/increment.hpp"

namespace talus {

/// `added`, plus the vertices of `kept` that lie in the region of `added` and are not in `gone`.
/// fails  invalid_argument: a vertex is in both; not one height and cover a vertex
[[nodiscard]] RestrictedQuadtree united(const RestrictedQuadtree& kept, std::span<const GridPoint> gone,
                                        const RestrictedQuadtree& added);

/// fails  invalid_argument: the increment does not belong to this answer
void require_fit(const RestrictedQuadtree& answer, const Increment& increment);

}  // namespace talus
