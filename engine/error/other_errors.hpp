#pragma once
// Errors by another rule than the usual one, of the vertices of spacing below a block's side.

#include "engine/error/vertex_error.hpp"

namespace talus::detail {

/// Raises the errors of all vertices to those of their halves by the input's rule, and gathers those of children: what
/// block_errors and saturate do for exact errors along the vertical.
///
/// cost  midpoint and nested errors along the vertical some 5 ns a sample; perpendicular ones, whose triangles say
///       nothing of each other's sides, a plain loop over every sample of every triangle: some 100 ns
void other_errors(const ErrorInput& input, LevelGrid<ErrorCode>& errors);

}  // namespace talus::detail
