#include "engine/block_bits.hpp"

#include <algorithm>
#include <bit>

namespace talus {
namespace {

/// Bits of the numbers of a rectangle.
template <class Code>
BitRange bits_within(const HeightField& field, std::span<const Code> heights, GridRect part) {
  BitRange bits;
  const auto width = static_cast<std::size_t>(part.cols());
  for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
    const Code* line = &heights[field.index({part.first.col, row})];
    if constexpr (std::is_same_v<Code, float>) {
      // Without a branch: a mantissa's lowest bit is a power of two, whose exponent as a float says where it stands.
      int finest = BitRange::kNone, coarsest = -BitRange::kNone;
      for (std::size_t i = 0; i < width; ++i) {
        const auto word = static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(line[i]) & 0x7fffffffu);
        const std::int32_t mantissa = (word & 0x7fffff) | 0x800000, exponent = word >> 23;
        const std::int32_t lowest = std::bit_cast<std::int32_t>(static_cast<float>(mantissa & -mantissa)) >> 23;
        const int low = exponent - 127 - 23 + lowest - 127, high = exponent - 127;
        finest = std::min(finest, word == 0 ? int{BitRange::kNone} : low);
        coarsest = std::max(coarsest, word == 0 ? -int{BitRange::kNone} : high);
      }
      if (finest > -127 - 23 && coarsest < 128) {
        bits.take(BitRange{static_cast<std::int16_t>(finest), static_cast<std::int16_t>(coarsest)});
        continue;
      }  // a denormal among them, or no number: one by one
    }
    for (std::size_t i = 0; i < width; ++i) bits.take(static_cast<double>(line[i]));
  }
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
      const GridRect part{{std::max(c, e.first.col), std::max(r, e.first.row)},
                          {std::min(c + kBlockSide, e.last.col), std::min(r + kBlockSide, e.last.row)}};
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
