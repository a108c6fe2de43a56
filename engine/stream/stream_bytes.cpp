#include "engine/stream/stream_bytes.hpp"

#include <xxhash.h>

namespace talus {

std::uint64_t stream_checksum(std::span<const std::byte> bytes, std::uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

}  // namespace talus
