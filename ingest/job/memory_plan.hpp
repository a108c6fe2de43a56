#pragma once
// The threads, panels and caches that a memory limit allows.

#include <cstdint>

#include "engine/tile/tile.hpp"

namespace talus {

struct WorkingMemory {
  unsigned threads = 1;
  std::int32_t tiles_across = 1;  ///< tiles in a panel
  std::uint64_t gdal_cache_bytes = 0;
};

/// bytes_a_code  size of a height in memory
/// block_bytes   the largest block that GDAL reads as a whole
/// threads       0: one per core. Fewer are used if memory is short; results do not depend on the number.
/// fails         invalid_argument: too little memory; names the least that is enough
[[nodiscard]] WorkingMemory budget_for(std::uint64_t memory_bytes, int threads, GridRect extent,
                                       std::size_t bytes_a_code, std::uint64_t block_bytes);

}  // namespace talus
