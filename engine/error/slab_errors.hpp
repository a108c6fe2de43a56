#pragma once
// Distances over triangles larger than a block, by planes near the samples of blocks.

#include <span>
#include <vector>

#include "engine/error/block_kernel.hpp"
#include "engine/error/vertex_error.hpp"

namespace talus::detail {

/// What a block's own kBlockSide² samples are: a plane near them, and how far they are from it.
struct BlockShape {
  bool has_data = false;  ///< any valid sample; if not, nothing else is said
  /// middle + right·(col − centre col) + down·(row − centre row), in double; all valid samples lie between it less
  /// `below` and it plus `above`, the rounding of evaluating that included.
  float middle = 0, right = 0, down = 0, above = 0, below = 0;
  double typical = 0;  ///< the valid sample nearest to the middle of their range, the lower of two
  SlabRanges slabs;    ///< the same by 8×8 samples, above and below zero; low > high where none is valid
};

/// The shapes of a rectangle of blocks, row by row; samples beyond the field are not valid.
[[nodiscard]] std::vector<BlockShape> block_shapes(const HeightField& field, GridRect blocks);

/// The largest distance, in codes, of any valid sample of each closed half-diamond from the plane through its
/// corners. Exact, the numbers of the plain loop; about linear in the samples.
///
/// shapes  of `blocks`, which own all samples of the halves
void largest_distances(const HeightField& field, std::span<const BlockShape> shapes, GridRect blocks,
                       std::span<const HalfDiamond> halves, std::span<double> distances);

}  // namespace talus::detail
