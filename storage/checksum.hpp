#pragma once
// XXH3 over a page's key and content. LMDB notices no damage; this does.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "storage/page_store.hpp"

namespace talus {

inline constexpr std::size_t kChecksumBytes = 8;

/// Over table, position and content, so that a page in another's place is damage, too.
[[nodiscard]] std::uint64_t page_checksum(PageKey key, std::span<const std::byte> content);

/// XXH3 over the bytes of the files, one after the other. Fails with io.
[[nodiscard]] std::uint64_t checksum_of_files(const std::vector<std::filesystem::path>& files);

}  // namespace talus
