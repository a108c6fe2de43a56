#pragma once
// What a limit of memory allows.

#include <cstdint>

#include "engine/tile/tile.hpp"

namespace talus {

struct WorkingMemory {
  unsigned threads = 1;
  std::int32_t tiles_across = 1;  ///< of a panel
  std::uint64_t gdal_cache_bytes = 0;
};

/// bytes_a_code, block_bytes  of heights in memory, and of the largest block of the inputs that is read as a whole.
/// `threads` 0: one a core. Fewer threads are taken where memory is short; results do not depend on it.
/// fails  invalid_argument: too little to work in, naming what would do
[[nodiscard]] WorkingMemory budget_for(std::uint64_t memory_bytes, int threads, GridRect extent,
                                       std::size_t bytes_a_code, std::uint64_t block_bytes);

}  // namespace talus
