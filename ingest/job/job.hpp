#pragma once
// The work that ingest and update share, as in docs/architecture.md.

#include <chrono>
#include <functional>

#include "engine/geo/ground_scale.hpp"
#include "engine/page/manifest.hpp"
#include "ingest/job/memory_plan.hpp"
#include "ingest/job/panels.hpp"
#include "ingest/job/tile_pages.hpp"
#include "ingest/mosaic/input_files.hpp"
#include "ingest/mosaic/source.hpp"
#include "storage/page_store.hpp"
#include "talus/ingest.hpp"

namespace talus {

/// The work of an ingest or update. Threads only read it.
struct Job {
  const IngestOptions& options;
  Description description;
  ReadWindow read;
  std::function<bool(TileId)> is_stale;  ///< whether a tile in the file must be computed again
  PageMaking making;
  InputFiles* files = nullptr;  ///< checked after each panel is read, and before the file is finished
  // Derived from the above:
  GroundScale ground;
  CodeDistance distance;
  WorkingMemory budget;
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
};

/// A job for a raster.
///
/// read          reads heights; each is `bytes_a_code` wide
/// block_bytes   the largest block of the inputs
/// fails         invalid_argument: options that contradict each other, too little memory
[[nodiscard]] Job job_of(const Description& description, std::size_t bytes_a_code, std::uint64_t block_bytes,
                         ReadWindow read, const IngestOptions& options);

/// Reports a stage before the first tile.
void tell_of(const Job& job, const char* stage);

/// Computes a few of the wanted tiles, writes nothing, and extrapolates to all.
[[nodiscard]] IngestEstimate estimate(const Job& job, const Source& source,
                                      const std::function<bool(TileId)>& is_wanted);

/// Computes all missing and stale tiles, then the levels above tiles, and finishes the file.
/// fails  invalid_argument: all void; full, io, and what reading fails with
[[nodiscard]] IngestReport run(Job& job, const Source& source, Provenance provenance, PageWriter& writer);

}  // namespace talus
