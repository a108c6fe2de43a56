#pragma once
// A rectangle and a tolerance become a restricted quadtree.

#include <optional>

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"

namespace talus {

/// A region and a tolerance, see Snapshot::ask. Threads change nothing in the answer.
///
/// from  leaves out what the answer at this tolerance has, and what the border needs: see Question::from. Both
///       answers agree to the bit on what counts in the bound: of pages with nothing above the tolerance their entries,
///       of all others the vertices in the region that the border does not need
[[nodiscard]] Answer range_query(const StoredPages& pages, GridRect region, Metres tolerance, int threads = 1,
                                 std::optional<Metres> from = {}, Watch& watch = unwatched());

struct StoredSamples {
  SampleWindow window;
  std::vector<std::uint8_t> dropped;  ///< 1 where a height was not kept and the value says nothing; empty: nowhere
};
/// The samples of a region from the finest pages.
[[nodiscard]] StoredSamples stored_samples(const StoredPages& pages, GridRect region, Watch& watch = unwatched());
/// The same where every sample was kept.
/// fails  unsupported: a database that keeps the vertices of a tolerance only
[[nodiscard]] SampleWindow all_samples(const StoredPages& pages, GridRect region, Watch& watch = unwatched());

}  // namespace talus
