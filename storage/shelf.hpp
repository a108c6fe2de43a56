#pragma once
// How pages stand in values of LMDB: alone, or sixty-four on a shelf. docs/format/v2.md has the bytes.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/page_store.hpp"

namespace talus {

using KeyBytes = std::array<std::uint8_t, 8>;
[[nodiscard]] KeyBytes key_bytes(std::uint64_t position);
[[nodiscard]] std::uint64_t position_of(const void* key);

/// Where LMDB keeps a page: its own position, or its shelf's.
[[nodiscard]] constexpr std::uint64_t value_position(PageKey key) {
  return is_shelved(key.table) ? key.position >> kShelfShift : key.position;
}

/// A page as it is stored: checksum, generation, content.
[[nodiscard]] std::vector<std::byte> wrapped(PageKey key, std::uint32_t generation, std::span<const std::byte> content);
/// fails  corrupt: too short, or the checksum is another
[[nodiscard]] StoredPage unwrapped(PageKey key, std::span<const std::byte> stored);

using ShelfPages = std::array<std::vector<std::byte>, kShelfPages>;  ///< wrapped; empty where there is none
/// Bytes of a shelf's value.
[[nodiscard]] std::size_t shelf_size(const ShelfPages& pages);
/// Lays a shelf's value down in that many bytes.
void lay_shelf(int table, std::uint64_t shelf, const ShelfPages& pages, std::byte* to);
/// The stored bytes of each page of a shelf; empty where there is none.
/// fails  corrupt
[[nodiscard]] std::array<std::span<const std::byte>, kShelfPages> pages_of_shelf(int table, std::uint64_t shelf,
                                                                                 std::span<const std::byte> value);

}  // namespace talus
