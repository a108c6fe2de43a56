#pragma once
// Errors of the vertices of spacing below a block's side, by fast kernels.

#include "engine/error/vertex_error.hpp"

namespace talus::detail {

/// Raises errors to those of the halves in the blocks from first to last, by column and row. After saturation the
/// result equals reference_errors. Blocks without voids go side by side in the lanes of a vector; then only the
/// interior and the hypotenuse of a triangle count, because its legs are hypotenuses of its children.
void block_errors(const ErrorInput& input, GridRect blocks, LevelGrid<ErrorCode>& errors);

}  // namespace talus::detail
