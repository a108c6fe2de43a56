#pragma once
// Whether arithmetic rounds, block by block, so that a vertex's error depends on nothing far away.

#include <vector>

#include "engine/error/height_field.hpp"
#include "engine/quadtree/half_diamond.hpp"

namespace talus {

/// Cells along a block's side. Vertices of smaller spacing are computed within blocks.
inline constexpr int kBlockShift = 6;
inline constexpr std::int32_t kBlockSide = 1 << kBlockShift;

/// Column and row of the block that contains a half-diamond of spacing below kBlockSide.
[[nodiscard]] constexpr GridPoint block_of(const HalfDiamond& t) {
  // The middle of a triangle is never on the side of a block.
  const auto middle = [](std::int32_t three) {
    const std::int32_t n = 3 * kBlockSide;
    return three >= 0 ? three / n : -((n - 1 - three) / n);
  };
  return {middle(t.apex.col + t.a.col + t.b.col), middle(t.apex.row + t.a.row + t.b.row)};
}

/// visit(block), by column and row, for each block that overlaps a half-diamond of spacing kBlockSide or more.
template <class Visit>
void for_each_block(GridPoint vertex, int side, Visit&& visit) {
  const HalfDiamond t = half_diamond({vertex.col >> kBlockShift, vertex.row >> kBlockShift}, side);
  for (std::int32_t row = t.top(); row < t.bottom(); ++row) {
    const auto above = t.columns(row), below = t.columns(row + 1);
    for (std::int32_t col = std::min(above.lo, below.lo); col < std::max(above.hi, below.hi); ++col) {
      visit(GridPoint{col, row});
    }
  }
}

/// The bits used in each closed block of a field: all (kBlockSide + 1)² samples and fills.
class BlockBits {
 public:
  explicit BlockBits(const HeightField& field);

  /// A block outside the field uses no bits.
  [[nodiscard]] BitRange operator[](GridPoint block) const {
    const std::int32_t col = block.col - first_.col, row = block.row - first_.row;
    if (col < 0 || row < 0 || col >= cols_ || row >= rows_) return {};
    return blocks_[static_cast<std::size_t>(row * cols_ + col)];
  }
  /// Whether interpolation is exact in every block alone.
  [[nodiscard]] bool all_exact() const { return all_exact_; }
  /// Whether every interpolation over the half-diamond is exact in double. It depends on the half's own block; for a
  /// large half on all blocks that it touches, each alone and together.
  [[nodiscard]] bool is_exact(GridPoint vertex, int side) const;

 private:
  GridPoint first_;
  std::int32_t cols_ = 0, rows_ = 0;
  std::vector<BitRange> blocks_;
  bool all_exact_ = true;
};

}  // namespace talus
