#include "engine/page/digest.hpp"

#include <xxhash.h>

namespace talus {

std::uint64_t digest_of(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

}  // namespace talus
