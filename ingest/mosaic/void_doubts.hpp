#pragma once
// Finds heights that may mean no data although no file declares it.

#include <cstdint>
#include <string>
#include <vector>

#include "ingest/mosaic/source.hpp"

namespace talus {

/// Neighbours of samples that are exactly 0. At a coast most are close to 0; around holes most are not.
struct ZeroEdges {
  std::uint64_t all = 0, steep = 0;  ///< neighbours, and how many of them are far from 0
};
/// Counts the edges between samples in `own`. Codes times `metres_per_code` are metres.
void count_zero_edges(const Window& window, GridRect own, double metres_per_code, ZeroEdges& edges);

/// Sentences on doubtful heights, in the vertical unit.
///
/// all_declare  every input declares a void value, so InputOptions::nodata would change nothing
[[nodiscard]] std::vector<std::string> void_doubts(double minimum, double maximum, const ZeroEdges& edges,
                                                   const std::string& unit, bool all_declare);

}  // namespace talus
