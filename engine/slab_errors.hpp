#pragma once
// Distances over triangles larger than a block.

#include <span>

#include "engine/vertex_error.hpp"

namespace talus::detail {

/// The largest distance, in codes, of any valid sample of each closed half-diamond from the plane through its
/// corners. Exact, the numbers of the plain loop; about linear in the samples of the square.
///
/// square  of samples within the field, all halves in it
void largest_distances(const HeightField& field, GridRect square, std::span<const HalfDiamond> halves,
                       std::span<double> distances);

}  // namespace talus::detail
