#pragma once
// The bits of a page's square in a mask over a region, and back.

#include "engine/dense/square_bits.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Adds the vertices of a square to a mask. Bits of the square outside the mask's region are 0.
///
/// first   the grid point of the square's first sample; its samples are grid points of spacing 1
/// shared  other threads may change other bits of the same words at the same time
void insert_square(const SquareBits& bits, GridPoint first, bool shared, VertexMask& mask);
/// The vertices of a mask in a square.
[[nodiscard]] SquareBits square_of(VertexMask& mask, GridPoint first, bool shared);

}  // namespace talus
