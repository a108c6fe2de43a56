#pragma once
// Saturation: no vertex has a smaller error than a vertex that depends on it. Then a threshold alone selects a set that
// holds the parents of each member. [P98 §7, Eq. 3]

#include "engine/error/vertex_error.hpp"

namespace talus {

/// Raises each error to the largest of the vertex's descendants: finest level first, each parent from its children.
/// Afterwards 0 means that every valid sample of the diamond lies exactly on the surface without the vertex. Linear
/// time. If the field is part of a larger one, vertices with descendants outside get errors that are too low.
void saturate(const ErrorInput& input, LevelGrid<ErrorCode>& errors);

}  // namespace talus
