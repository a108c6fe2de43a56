#pragma once
// XXH3 over a page's key and content. LMDB notices no damage; this does.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "storage/page_store.hpp"

namespace talus {

/// What stands before a page's content: the checksum, big endian, and the generation, little endian.
inline constexpr std::size_t kChecksumBytes = 8, kPagePrefixBytes = kChecksumBytes + 4;

/// Over table, position, generation and content, so that a page in another's place is damage, too.
[[nodiscard]] std::uint64_t page_checksum(PageKey key, std::uint32_t generation, std::span<const std::byte> content);

/// XXH3 over the bytes of a file. `tell` is called every few megabytes and may throw. Fails with io.
[[nodiscard]] std::uint64_t checksum_of_file(const std::filesystem::path& file, const std::function<void()>& tell);
/// XXH3 over numbers, each as 8 bytes, big endian.
[[nodiscard]] std::uint64_t checksum_of(std::span<const std::uint64_t> numbers);

}  // namespace talus
