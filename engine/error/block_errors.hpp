#pragma once
// Errors of the vertices of spacing below a block's side, fast.

#include "engine/error/vertex_error.hpp"

namespace talus::detail {

/// Raises the errors of all vertices to those of their halves that lie in the blocks, first to last by column
/// and row. The same as reference_errors up to saturation: where all of a block is data, several go
/// side by side in the lanes of a vector, and only the interior and the hypotenuse of each triangle count (its
/// legs are its children's hypotenuses, so saturation brings them back).
void block_errors(const ErrorInput& input, GridRect blocks, LevelGrid<ErrorCode>& errors);

}  // namespace talus::detail
