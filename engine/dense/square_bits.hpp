#pragma once
// A bit for each sample of a page's square.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/dense/dense_kernel.hpp"

namespace talus {

/// By row of the square: bit c mod 64 of word c / 64.
using SquareBits = std::array<std::uint64_t[2], detail::kDenseSide>;

[[nodiscard]] std::size_t count(const SquareBits& bits);
[[nodiscard]] inline bool has(const SquareBits& bits, int col, int row) {
  return (bits[static_cast<std::size_t>(row)][col / 64] >> (col % 64) & 1) != 0;
}
inline void insert(SquareBits& bits, int col, int row) {
  bits[static_cast<std::size_t>(row)][col / 64] |= std::uint64_t{1} << (col % 64);
}
/// The same for sample `at` of the square, row by row.
[[nodiscard]] inline bool has(const SquareBits& bits, std::size_t at) {
  return has(bits, static_cast<int>(at % detail::kDenseSide), static_cast<int>(at / detail::kDenseSide));
}
inline void insert(SquareBits& bits, std::size_t at) {
  insert(bits, static_cast<int>(at % detail::kDenseSide), static_cast<int>(at / detail::kDenseSide));
}

/// Inserts those of a row's samples from `col` on whose byte is 1; the others are 0.
void insert_row(SquareBits& bits, int col, int row, std::span<const std::uint8_t> bytes);

/// All bits within one column and one row of a bit.
[[nodiscard]] SquareBits grown(const SquareBits& bits);

/// The bits of `all` that `some` lacks.
[[nodiscard]] inline SquareBits without(SquareBits all, const SquareBits& some) {
  for (std::size_t row = 0; row < all.size(); ++row) all[row][0] &= ~some[row][0], all[row][1] &= ~some[row][1];
  return all;
}

/// The vertices of spacing 1, 2 and 4 whose errors follow from the heights of the square, if these samples are data:
/// engine/page/page_errors.hpp says why.
[[nodiscard]] SquareBits implied_places(const SquareBits& data);

/// Calls visit(col, row) for all bits, row by row.
template <class Visit>
void for_each_bit(const SquareBits& bits, Visit&& visit) {
  for (int row = 0; row < detail::kDenseSide; ++row) {
    for (int word = 0; word < 2; ++word) {
      for (std::uint64_t rest = bits[static_cast<std::size_t>(row)][word]; rest != 0; rest &= rest - 1)
        visit(64 * word + __builtin_ctzll(rest), row);
    }
  }
}

}  // namespace talus
