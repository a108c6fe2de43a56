#pragma once
// Saturation: no vertex's error below one that depends on it, so that a threshold alone selects a set
// closed under parents. [P98 §7, Eq. 3]

#include "engine/error/vertex_error.hpp"

namespace talus {

/// Raises every error to the largest among its vertex's descendants, finest level first; each parent
/// gathers from its children. Afterwards an error of zero means exactly: every valid sample of the diamond lies on
/// the surface without the vertex. Linear time. Where the field is cut out of a larger one, the errors of
/// vertices whose descendants lie beyond it come out too low.
void saturate(const ErrorInput& input, LevelGrid<ErrorCode>& errors);

}  // namespace talus
