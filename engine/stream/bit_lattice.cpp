#include "engine/stream/bit_lattice.hpp"

#include <algorithm>

namespace talus {

BitLattice::BitLattice(GridRect window, int log_spacing) : shift(log_spacing) {
  const std::int64_t up = (std::int64_t{1} << shift) - 1;
  first_col = static_cast<std::int32_t>((window.first.col + up) >> shift);
  first_row = static_cast<std::int32_t>((window.first.row + up) >> shift);
  cols = std::max(0, (window.last.col >> shift) - first_col + 1);
  rows = std::max(0, (window.last.row >> shift) - first_row + 1);
  words_per_row = (static_cast<std::size_t>(cols) + 63) / 64;
  words.resize(words_per_row * static_cast<std::size_t>(rows));
}

BitLattice bits_of(const VertexMask& mask) {
  BitLattice all(mask.region(), 0);
  for (std::int32_t j = 0; j < all.rows; ++j) {
    const auto from = mask.row_words(all.first_row + j);
    std::copy(from.begin(), from.end(), all.row(j));
  }
  return all;
}

BitLattice coarser(const BitLattice& fine, GridRect window) {
  BitLattice half(window, fine.shift + 1);
  const unsigned odd = fine.starts_odd();
  for (std::int32_t j = 0; j < half.rows; ++j) {
    const std::uint64_t* from = fine.row(2 * (half.first_row + j) - fine.first_row);
    std::uint64_t* to = half.row(j);
    for (std::size_t w = 0; w < half.words_per_row; ++w) {
      const std::uint64_t low = gathered_bits(from[2 * w] >> odd);
      const std::uint64_t high = 2 * w + 1 < fine.words_per_row ? gathered_bits(from[2 * w + 1] >> odd) : 0;
      to[w] = low | high << 32;
    }
  }
  return half;
}

}  // namespace talus
