#include "engine/error/block_bits.hpp"

#include <algorithm>
#include <bit>

#include "engine/error/kernel_choice.hpp"
#include "engine/quadtree/rect.hpp"

namespace talus {
namespace {

/// The bits that the numbers of a rectangle use.
template <class Code>
BitRange bits_within(const HeightField& field, std::span<const Code> heights, GridRect part) {
  BitRange bits;
  if constexpr (std::is_same_v<Code, float>) {
    const auto [lowest, highest] =
        detail::block_kernel().bits(&heights[field.index(part.first)], field.extent.cols(),
                                    static_cast<int>(part.cols()), static_cast<int>(part.rows()));
    if (lowest > -127 - 23 && highest < 128) {
      return {static_cast<std::int16_t>(lowest), static_cast<std::int16_t>(highest)};
    }
  }
  for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
    const Code* line = &heights[field.index({part.first.col, row})];
    for (std::int64_t col = 0; col < part.cols(); ++col) bits.take(static_cast<double>(line[col]));
  }
  return bits;
}

}  // namespace

BlockBits::BlockBits(const HeightField& field) {
  const GridRect& e = field.extent;
  // The field touches a block whose closed square begins on the field's last column, and one that ends on its first.
  first_ = {(e.first.col - 1) >> kBlockShift, (e.first.row - 1) >> kBlockShift};
  cols_ = (e.last.col >> kBlockShift) - first_.col + 1;
  rows_ = (e.last.row >> kBlockShift) - first_.row + 1;
  for (std::int32_t row = first_.row; row < first_.row + rows_; ++row) {
    for (std::int32_t col = first_.col; col < first_.col + cols_; ++col) {
      const GridRect part = common(square({col * kBlockSide, row * kBlockSide}, kBlockSide + 1), e);
      blocks_.push_back(std::visit(
          [&](auto heights) {
            using Code = std::remove_const_t<typename decltype(heights)::element_type>;
            return bits_within<Code>(field, heights, part);
          },
          field.heights));
      all_exact_ = all_exact_ && blocks_.back().interpolates_exactly(kBlockSide);
    }
  }
}

bool BlockBits::is_exact(GridPoint vertex, int side) const {
  const HalfDiamond t = half_diamond(vertex, side);
  if (t.s < kBlockSide) return (*this)[block_of(t)].interpolates_exactly(kBlockSide);
  BitRange all;
  bool each = true;
  for_each_block(vertex, side, [&](GridPoint block) {
    const BitRange bits = (*this)[block];
    each = each && bits.interpolates_exactly(kBlockSide);
    all.take(bits);
  });
  return each && all.interpolates_exactly(2 * t.s);
}

}  // namespace talus
