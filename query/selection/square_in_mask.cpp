#include "query/selection/square_in_mask.hpp"

#include <algorithm>
#include <atomic>

#include "engine/page/page_layout.hpp"

namespace talus {
namespace {

/// visit(row of the square, words of the mask's row, the first word, bit in it): where the square's first column is, or
/// the first one in the region; `skipped` columns of the square lie west of it.
template <class Visit>
void for_each_row_of(VertexMask& mask, GridPoint first, Visit&& visit) {
  const GridRect& region = mask.region();
  const std::int64_t at = std::int64_t{first.col} - region.first.col;
  if (at <= -kPageSide) return;
  const auto skipped = static_cast<int>(at < 0 ? -at : 0);
  const auto col = static_cast<std::size_t>(at < 0 ? 0 : at);
  const std::int32_t from = std::max(first.row, region.first.row);
  const std::int32_t to =
      static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{first.row} + kPageSide - 1, region.last.row));
  for (std::int32_t row = from; row <= to; ++row) {
    const auto words = mask.row_words(row);
    if (col / 64 < words.size())
      visit(static_cast<std::size_t>(row - first.row), words.subspan(col / 64), static_cast<int>(col % 64), skipped);
  }
}

using Bits = unsigned __int128;

}  // namespace

void insert_square(const SquareBits& bits, GridPoint first, bool shared, VertexMask& mask) {
  for_each_row_of(mask, first, [&](std::size_t row, std::span<std::uint64_t> words, int bit, int skipped) {
    const Bits all = (Bits{bits[row][1]} << 64 | bits[row][0]) >> skipped;
    const std::uint64_t parts[] = {static_cast<std::uint64_t>(all << bit), static_cast<std::uint64_t>(all << bit >> 64),
                                   bit == 0 ? 0 : static_cast<std::uint64_t>(all >> (128 - bit))};
    for (std::size_t i = 0; i < std::min<std::size_t>(3, words.size()); ++i) {
      if (parts[i] == 0) continue;
      if (shared) {
        std::atomic_ref(words[i]).fetch_or(parts[i], std::memory_order_relaxed);
      } else {
        words[i] |= parts[i];
      }
    }
  });
}

SquareBits square_of(VertexMask& mask, GridPoint first, bool shared) {
  SquareBits bits{};
  for_each_row_of(mask, first, [&](std::size_t row, std::span<std::uint64_t> words, int bit, int skipped) {
    std::uint64_t parts[3] = {0, 0, 0};
    for (std::size_t i = 0; i < std::min<std::size_t>(3, words.size()); ++i)
      parts[i] = shared ? std::atomic_ref(words[i]).load(std::memory_order_relaxed) : words[i];
    Bits all = (Bits{parts[1]} << 64 | parts[0]) >> bit;
    if (bit != 0) all |= Bits{parts[2]} << (128 - bit);
    all <<= skipped;
    bits[row][0] = static_cast<std::uint64_t>(all);
    bits[row][1] = static_cast<std::uint64_t>(all >> 64);
  });
  return bits;
}

}  // namespace talus
