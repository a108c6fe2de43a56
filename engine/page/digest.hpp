#pragma once
// A digest of bytes, by which pages know what they were written beside.

#include <cstddef>
#include <cstdint>
#include <span>

namespace talus {

/// XXH3 with 64 bits, seed 0.
[[nodiscard]] std::uint64_t digest_of(std::span<const std::byte> bytes);

}  // namespace talus
