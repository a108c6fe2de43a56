#pragma once
// Pages in LMDB's values: alone, or sixty-four on a shelf. docs/format/v3.md has the bytes.

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

/// LMDB's key of a page: its own position, or that of its shelf.
[[nodiscard]] constexpr std::uint64_t value_position(PageKey key) {
  return is_shelved(key.table) ? key.position >> kShelfShift : key.position;
}

/// The stored form of a page: checksum, generation, content.
[[nodiscard]] std::vector<std::byte> wrapped(PageKey key, std::uint32_t generation, std::span<const std::byte> content);
/// fails  corrupt: too short, or a wrong checksum
[[nodiscard]] StoredPage unwrapped(PageKey key, std::span<const std::byte> stored);

using ShelfPages = std::array<std::vector<std::byte>, kShelfPages>;  ///< stored forms; empty: no page
/// Size of a shelf's value in bytes.
[[nodiscard]] std::size_t shelf_size(const ShelfPages& pages);
/// Writes a shelf's value, shelf_size() bytes.
void lay_shelf(int table, std::uint64_t shelf, const ShelfPages& pages, std::byte* to);
/// The stored form of each page of a shelf; empty: no page.
/// fails  corrupt
[[nodiscard]] std::array<std::span<const std::byte>, kShelfPages> pages_of_shelf(int table, std::uint64_t shelf,
                                                                                 std::span<const std::byte> value);

}  // namespace talus
