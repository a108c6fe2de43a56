#include "engine/block_bits.hpp"

#include <algorithm>

namespace talus {
namespace {

BitRange bits_within(const HeightField& field, GridRect part) {
  BitRange bits;
  std::visit(
      [&](auto heights) {
        for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
          const auto* line = &heights[field.index({part.first.col, row})];
          for (std::int64_t col = 0; col < part.cols(); ++col) bits.take(static_cast<double>(line[col]));
        }
      },
      field.heights);
  return bits;
}

}  // namespace

BlockBits::BlockBits(const HeightField& field) {
  const GridRect& e = field.extent;
  // A block whose closed square starts on the field's last column belongs to it, too, and so does one that
  // ends on its first.
  first_ = {(e.first.col - 1) >> kBlockShift, (e.first.row - 1) >> kBlockShift};
  cols_ = (e.last.col >> kBlockShift) - first_.col + 1;
  rows_ = (e.last.row >> kBlockShift) - first_.row + 1;
  for (std::int32_t row = first_.row; row < first_.row + rows_; ++row) {
    for (std::int32_t col = first_.col; col < first_.col + cols_; ++col) {
      const std::int32_t c = col * kBlockSide, r = row * kBlockSide;
      blocks_.push_back(
          bits_within(field, {{std::max(c, e.first.col), std::max(r, e.first.row)},
                              {std::min(c + kBlockSide, e.last.col), std::min(r + kBlockSide, e.last.row)}}));
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
