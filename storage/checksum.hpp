#pragma once
// XXH3 over a page's key and content. LMDB notices no damage; this does.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "storage/page_store.hpp"

namespace talus {

/// What stands before a page's content: the checksum, big endian, and the generation, little endian.
inline constexpr std::size_t kChecksumBytes = 8, kPagePrefixBytes = kChecksumBytes + 4;

/// Over table, position, generation and content, so that a page in another's place is damage, too.
[[nodiscard]] std::uint64_t page_checksum(PageKey key, std::uint32_t generation, std::span<const std::byte> content);

/// XXH3 over the bytes of the files, one after the other. Fails with io.
[[nodiscard]] std::uint64_t checksum_of_files(const std::vector<std::filesystem::path>& files);

}  // namespace talus
