#pragma once
// LMDB's values: a page alone, or all that belongs to a tile. docs/format/v3.md has the bytes.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/page_store.hpp"

namespace talus {

/// A position has 32 bits of each coordinate, which take turns, and the sign bits of both are flipped: the two highest
/// bits. A tile's coordinates are those of its pages of band 0 shifted by three bits, with their signs.
inline constexpr std::uint64_t kSigns = std::uint64_t{3} << 62;
[[nodiscard]] constexpr std::uint64_t tile_of(std::uint64_t page) {
  std::uint64_t tile = (page ^ kSigns) / kTilePages;
  for (const int sign : {56, 57}) {
    if ((tile >> sign & 1) != 0) tile |= std::uint64_t{0x54} << sign;  // the three bits above of this coordinate
  }
  return tile ^ kSigns;
}

/// The key of a page's value: its own, or that of its tile, whose table is kTileTable.
[[nodiscard]] constexpr PageKey value_key(PageKey key) {
  if (!is_of_tile(key.table)) return key;
  return {kTileTable, key.table == 0 ? tile_of(key.position) : key.position};
}
/// The same as bytes: a number for the table, and the position, big endian.
using KeyBytes = std::array<std::uint8_t, 9>;
[[nodiscard]] KeyBytes key_bytes(PageKey value);
/// Nothing: no value has such a key.
[[nodiscard]] std::optional<PageKey> key_from(std::span<const std::byte> bytes);

/// The stored form of a page: checksum, generation, content.
[[nodiscard]] std::vector<std::byte> wrapped(PageKey key, std::uint32_t generation, std::span<const std::byte> content);
/// fails  corrupt: too short, or a wrong checksum
[[nodiscard]] StoredPage unwrapped(PageKey key, std::span<const std::byte> stored);

/// What a tile has, in the order of its bytes: its slice, which coarse questions read; its page of band 1; its pages of
/// band 0, those along its west side from the south on and then those along its north side first, because windows that
/// end beside the tile need just them; its record.
inline constexpr std::size_t kTileParts = kTilePages + 3;
[[nodiscard]] std::size_t part_of(PageKey key);
/// The pages of a table that a tile may have, and the position of page i.
[[nodiscard]] constexpr std::size_t pages_in_tile(int table) { return table == 0 ? kTilePages : 1; }
[[nodiscard]] constexpr std::uint64_t position_in_tile(int table, std::uint64_t tile, std::size_t i) {
  return table == 0 ? (tile * kTilePages + i) ^ kSigns : tile;
}

using TileParts = std::array<std::vector<std::byte>, kTileParts>;  ///< stored forms; empty: there is none
/// Size of a tile's value in bytes.
[[nodiscard]] std::size_t tile_size(const TileParts& parts);
/// Writes a tile's value, tile_size() bytes.
void lay_tile(std::uint64_t tile, const TileParts& parts, std::byte* to);
/// The stored form of each part of a tile; empty: there is none.
/// fails  corrupt
[[nodiscard]] std::array<std::span<const std::byte>, kTileParts> parts_of_tile(std::uint64_t tile,
                                                                               std::span<const std::byte> value);

}  // namespace talus
