#pragma once
// Verify, second part: computes everything again from the stored samples, and compares.

#include <array>
#include <cstdint>
#include <functional>

#include "engine/tile/tile_summary.hpp"
#include "query/verify/verify_pages.hpp"

namespace talus {

/// Sums over all tiles, to compare with the header.
struct TileTotals {
  std::uint64_t valid_samples = 0;
  double lowest = 0, highest = 0;  ///< in the vertical unit; meaningless without valid samples
  ErrorHistogram errors{};
};

/// Computes each tile from its samples and those around it, as ingest did, and compares it with its pages and its
/// record. If not all samples were kept, compares the record with the pages only.
///
/// told  called after each tile
/// cost  about 60 ns a sample; memory: about 40 MB
[[nodiscard]] TileTotals check_tiles(const StoredPages& pages, DecodedPages& decoded, const CheckedPages& of_band_1,
                                     Findings& findings, VerifyReport& report, const std::function<void()>& told);

/// Computes the pages above tiles from the records, which must be sound, and compares them.
/// cost  memory: 40 bytes for each 64² samples
void check_coarse(const StoredPages& pages, DecodedPages& decoded, Findings& findings);

/// How many tiles have a record.
[[nodiscard]] std::uint64_t tiles_in(GridRect extent);

}  // namespace talus
