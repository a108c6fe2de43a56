#pragma once
// Checksums (XXH3) of pages and files. LMDB does not notice damage by itself.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "storage/page_store.hpp"

namespace talus {

/// Before a page's content stand its checksum (big endian) and its generation (little endian).
inline constexpr std::size_t kChecksumBytes = 8, kPagePrefixBytes = kChecksumBytes + 4;

/// Includes table, position and generation, so that a page in the wrong place is damage too.
[[nodiscard]] std::uint64_t page_checksum(PageKey key, std::uint32_t generation, std::span<const std::byte> content);

/// XXH3 of a file's bytes. Calls `tell` every few megabytes; it may throw. fails  io
[[nodiscard]] std::uint64_t checksum_of_file(const std::filesystem::path& file, const std::function<void()>& tell);
/// XXH3 of numbers, each as 8 bytes, big endian.
[[nodiscard]] std::uint64_t checksum_of(std::span<const std::uint64_t> numbers);

}  // namespace talus
