#pragma once
// Answers a region and a tolerance with a restricted quadtree.

#include <optional>

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"

namespace talus {

/// The answer for a region and a tolerance, see Snapshot::ask. It does not depend on the number of threads.
///
/// from  a coarser tolerance: the answer leaves out its vertices and those of the border, see Question::from. The bound
///       equals that of the whole answer to the bit. Both count the child entries of pages without an error above the
///       tolerance, and in all other pages the vertices of the region that the border does not need
[[nodiscard]] Answer range_query(const StoredPages& pages, GridRect region, Metres tolerance, int threads = 1,
                                 std::optional<Metres> from = {}, Watch& watch = unwatched());

struct StoredSamples {
  SampleWindow window;
  std::vector<std::uint8_t> dropped;  ///< 1: the height was not kept, and the value means nothing; empty: all were kept
};
/// The samples of a region from the finest pages.
[[nodiscard]] StoredSamples stored_samples(const StoredPages& pages, GridRect region, Watch& watch = unwatched());
/// The samples of a region, from a database that keeps all samples.
/// fails  unsupported: the database keeps only the vertices of a tolerance
[[nodiscard]] SampleWindow all_samples(const StoredPages& pages, GridRect region, Watch& watch = unwatched());

}  // namespace talus
