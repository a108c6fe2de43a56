#pragma once
// Streams whose bytes were changed, with checksums that fit again: so that what lies behind them is reached.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include <xxhash.h>

#include "engine/stream/stream_header.hpp"

namespace talus {

/// Makes each checksum that the lengths lead to fit, and an increment's base the one that it is held against.
inline void reseal(std::vector<std::byte>& bytes, const RestrictedQuadtree& base) {
  const auto word = [&](std::size_t at) {
    std::uint32_t v = 0;
    if (at + 4 <= bytes.size()) std::memcpy(&v, &bytes[at], 4);
    return v;
  };
  std::size_t size = word(12);
  if (size < 264 || size > bytes.size()) return;
  if ((word(16) & 1) != 0) {
    const std::uint64_t digest = digest_of(base);
    std::memcpy(bytes.data() + 240, &digest, 8);
  }
  std::uint64_t seed = XXH3_64bits_withSeed(bytes.data(), size - 8, 0);
  std::memcpy(bytes.data() + size - 8, &seed, 8);
  for (std::size_t begin = size; begin + 12 <= bytes.size(); begin += size) {
    size = std::size_t{12} + word(begin);
    if (size > bytes.size() - begin) return;
    seed = XXH3_64bits_withSeed(bytes.data() + begin, size - 4, seed);
    std::memcpy(bytes.data() + begin + size - 4, &seed, 4);
  }
}

}  // namespace talus
