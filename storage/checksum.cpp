#include "storage/checksum.hpp"

#include <array>

#include <xxhash.h>

namespace talus {

std::uint64_t page_checksum(PageKey key, std::span<const std::byte> content) {
  std::array<std::uint8_t, 9> prefix{static_cast<std::uint8_t>(key.table)};
  for (std::size_t i = 0; i < 8; ++i) prefix[1 + i] = static_cast<std::uint8_t>(key.position >> (56 - 8 * i));
  return XXH3_64bits_withSeed(content.data(), content.size(), XXH3_64bits(prefix.data(), prefix.size()));
}

}  // namespace talus
