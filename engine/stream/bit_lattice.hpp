#pragma once
// The members of a set among the multiples of one spacing, a bit each: what one level of a quadtree sees of the others.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/quadtree/grid.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// The low 32 bits, apart: bit i becomes bit 2i.
[[nodiscard]] constexpr std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0xffffffffu;
  v = (v | v << 16) & 0x0000ffff0000ffffu;
  v = (v | v << 8) & 0x00ff00ff00ff00ffu;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0fu;
  v = (v | v << 2) & 0x3333333333333333u;
  return (v | v << 1) & 0x5555555555555555u;
}

/// The other way round: bit 2i becomes bit i.
[[nodiscard]] constexpr std::uint64_t gathered_bits(std::uint64_t v) {
  v &= 0x5555555555555555u;
  v = (v | v >> 1) & 0x3333333333333333u;
  v = (v | v >> 2) & 0x0f0f0f0f0f0f0f0fu;
  v = (v | v >> 4) & 0x00ff00ff00ff00ffu;
  v = (v | v >> 8) & 0x0000ffff0000ffffu;
  return (v | v >> 16) & 0xffffffffu;
}

/// The multiples of 2^shift in a window, row by row. Columns and rows count in spacings, `first_*` from the grid's
/// origin; bit i of a row is column first_col + i.
struct BitLattice {
  int shift = 0;
  std::int32_t first_col = 0, first_row = 0;
  std::int32_t cols = 0, rows = 0;
  std::size_t words_per_row = 0;
  std::vector<std::uint64_t> words;

  BitLattice() = default;
  /// None is a member.
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
  /// 1 if bit 0 has an odd column: bits of odd columns are then the even ones.
  [[nodiscard]] unsigned starts_odd() const { return static_cast<unsigned>(first_col) & 1u; }
};

/// All of a set's members, at spacing 1.
[[nodiscard]] BitLattice bits_of(const VertexMask& mask);

/// Those of the members that are multiples of twice the spacing.
[[nodiscard]] BitLattice coarser(const BitLattice& fine, GridRect window);

}  // namespace talus
