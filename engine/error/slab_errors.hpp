#pragma once
// The largest distances over triangles larger than a block, by planes near the samples of blocks.

#include <span>
#include <vector>

#include "engine/error/block_kernel.hpp"
#include "engine/error/vertex_error.hpp"

namespace talus::detail {

/// A plane near a block's own kBlockSide² samples, and how far they are from it.
struct BlockShape {
  bool has_data = false;  ///< a sample is valid; if not, the other members are unset
  /// middle + right·(col − centre col) + down·(row − centre row), in double. All valid samples lie between the plane
  /// minus `below` and the plane plus `above`; the rounding of this formula is included.
  float middle = 0, right = 0, down = 0, above = 0, below = 0;
  double typical = 0;  ///< the valid sample nearest to the middle of their range, the lower of two
  SlabRanges slabs;    ///< below and above for each 8×8 samples; low > high: none is valid
};

/// The shapes of a rectangle of blocks, row by row; samples outside the field are not valid.
[[nodiscard]] std::vector<BlockShape> block_shapes(const HeightField& field, GridRect blocks);

/// The largest distance, in codes, of the valid samples of each closed half-diamond from the plane through its corners.
/// Equal to the plain loop, in time about linear in the samples.
///
/// shapes  of `blocks`, which must own all samples of the halves
void largest_distances(const HeightField& field, std::span<const BlockShape> shapes, GridRect blocks,
                       std::span<const HalfDiamond> halves, std::span<double> distances);

}  // namespace talus::detail
