#pragma once
// A set of grid points as bits, one for each multiple of a spacing. A level's coder reads the coarser levels this way.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/quadtree/grid.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Spreads the low 32 bits: bit i becomes bit 2i.
[[nodiscard]] constexpr std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0xffffffffu;
  v = (v | v << 16) & 0x0000ffff0000ffffu;
  v = (v | v << 8) & 0x00ff00ff00ff00ffu;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0fu;
  v = (v | v << 2) & 0x3333333333333333u;
  return (v | v << 1) & 0x5555555555555555u;
}

/// The inverse of spread_bits: bit 2i becomes bit i.
[[nodiscard]] constexpr std::uint64_t gathered_bits(std::uint64_t v) {
  v &= 0x5555555555555555u;
  v = (v | v >> 1) & 0x3333333333333333u;
  v = (v | v >> 2) & 0x0f0f0f0f0f0f0f0fu;
  v = (v | v >> 4) & 0x00ff00ff00ff00ffu;
  v = (v | v >> 8) & 0x0000ffff0000ffffu;
  return (v | v >> 16) & 0xffffffffu;
}

/// The multiples of 2^shift in a window, row by row. Columns and rows are counted in spacings. `first_col` and
/// `first_row` are counted from the grid's origin; bit i of a row is column first_col + i.
struct BitLattice {
  int shift = 0;
  std::int32_t first_col = 0, first_row = 0;
  std::int32_t cols = 0, rows = 0;
  std::size_t words_per_row = 0;
  std::vector<std::uint64_t> words;

  BitLattice() = default;
  /// An empty set.
  BitLattice(GridRect window, int log_spacing);

  [[nodiscard]] std::uint64_t* row(std::int32_t j) {
    return words.data() + static_cast<std::size_t>(j) * words_per_row;
  }
  [[nodiscard]] const std::uint64_t* row(std::int32_t j) const {
    return words.data() + static_cast<std::size_t>(j) * words_per_row;
  }
  [[nodiscard]] bool contains(std::int32_t i, std::int32_t j) const {
    return i >= 0 && j >= 0 && i < cols && j < rows && (row(j)[i / 64] >> (i % 64) & 1u) != 0;
  }
  void insert(GridPoint p) {
    const std::int32_t i = (p.col >> shift) - first_col;
    row((p.row >> shift) - first_row)[i / 64] |= std::uint64_t{1} << (i % 64);
  }
  [[nodiscard]] GridPoint at(std::int32_t i, std::int32_t j) const {
    return {(first_col + i) * (1 << shift), (first_row + j) * (1 << shift)};
  }
  /// 1 if bit 0 is an odd column. The even bits are then odd columns.
  [[nodiscard]] unsigned starts_odd() const { return static_cast<unsigned>(first_col) & 1u; }
};

/// The vertices of a mask, at spacing 1.
[[nodiscard]] BitLattice bits_of(const VertexMask& mask);

/// The points of a set that are multiples of twice the spacing.
[[nodiscard]] BitLattice coarser(const BitLattice& fine, GridRect window);

}  // namespace talus
