#include "ingest/job/memory_plan.hpp"

#include <algorithm>

#include "engine/machine/fail.hpp"
#include "engine/machine/parallel.hpp"
#include "ingest/job/panels.hpp"

namespace talus {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
// Measured with tests/soak/ingest.sh: the program and its libraries; one thread with its results and the slice of its
// tile; pages that wait for their transaction, here and in LMDB.
constexpr std::uint64_t kProgram = 80 * kMiB, kThread = 80 * kMiB, kWriting = 56 * kMiB;

/// Memory for the posts: heights, errors and voids of every 64th sample.
std::uint64_t coarse_bytes(GridRect extent) {
  return static_cast<std::uint64_t>(extent.samples() / (kBlockSide * kBlockSide) * 48) + kMiB;
}

}  // namespace

WorkingMemory budget_for(std::uint64_t memory_bytes, int threads, GridRect extent, std::size_t bytes_a_code,
                         std::uint64_t block_bytes) {
  WorkingMemory budget;
  budget.gdal_cache_bytes = std::clamp(memory_bytes / 8, 16 * kMiB, 256 * kMiB);
  // Two panels, the current and the next, and a copy of the rows that they share.
  const auto needed = [&](unsigned crew, std::int32_t across) {
    // GDAL holds a block twice, as read and as samples, besides its cache.
    return kProgram + kWriting + 2 * block_bytes + budget.gdal_cache_bytes + coarse_bytes(extent) + crew * kThread +
           3 * window_bytes(across, bytes_a_code);
  };
  if (needed(1, 1) > memory_bytes) budget.gdal_cache_bytes = 16 * kMiB;
  if (needed(1, 1) > memory_bytes) {
    if (block_bytes > 64 * kMiB) {
      refuse(
          "a limit of {} bytes of memory is too small: an input has blocks of {} MiB, and each is read as a whole. "
          "Allow at least {} MiB, or write the input in tiles (gdal_translate -co TILED=YES)",
          memory_bytes, block_bytes / kMiB, needed(1, 1) / kMiB + 1);
    }
    refuse("a limit of {} bytes of memory is too small: {} × {} samples need {} MiB at least", memory_bytes,
           extent.cols(), extent.rows(), needed(1, 1) / kMiB + 1);
  }
  budget.threads = static_cast<unsigned>(threads_or_all(threads));
  while (budget.threads > 1 && needed(budget.threads, 1) > memory_bytes) --budget.threads;
  const GridRect tiles = tiles_of(extent);
  const auto all = static_cast<std::int32_t>(tiles.cols());
  while (budget.tiles_across < all && needed(budget.threads, budget.tiles_across + 1) <= memory_bytes)
    ++budget.tiles_across;
  return budget;
}

}  // namespace talus
