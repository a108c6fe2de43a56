#pragma once
// The work that an ingest and an update have in common: the steps of docs/architecture.md as code.

#include <chrono>
#include <functional>

#include "engine/geo/geodesy.hpp"
#include "engine/page/manifest.hpp"
#include "ingest/job/memory_plan.hpp"
#include "ingest/job/panels.hpp"
#include "ingest/job/tile_pages.hpp"
#include "ingest/mosaic/input_files.hpp"
#include "ingest/mosaic/source.hpp"
#include "storage/page_store.hpp"
#include "talus/ingest.hpp"

namespace talus {

/// Read by all threads, changed by none.
struct Job {
  const IngestOptions& options;
  Description description;
  ReadWindow read;
  std::function<bool(TileId)> is_stale;  ///< whether a tile that is there must be made anew
  PageMaking making;
  InputFiles* files = nullptr;  ///< looked at again after each panel is read, and before the file is finished
  // From these follow:
  GroundScale ground;
  CodeDistance distance;
  WorkingMemory budget;
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
};

/// A job for a raster; heights come from `read`, `bytes_a_code` wide, out of inputs with blocks of `block_bytes`.
/// fails  invalid_argument: options that make no sense, too little memory
[[nodiscard]] Job job_of(const Description& description, std::size_t bytes_a_code, std::uint64_t block_bytes,
                         ReadWindow read, const IngestOptions& options);

/// Tells, before the first tile, what is being done.
void tell_of(const Job& job, const char* stage);

/// Settles a few of the tiles that are wanted, keeps nothing and tells what all would take.
[[nodiscard]] IngestEstimate estimate(const Job& job, const Source& source,
                                      const std::function<bool(TileId)>& is_wanted);

/// Settles all tiles that are not there or are stale, then what is larger than a tile, and finishes the file.
/// fails  invalid_argument: all void; full, io, and what reading fails with
[[nodiscard]] IngestReport run(Job& job, const Source& source, Provenance provenance, PageWriter& writer);

}  // namespace talus
