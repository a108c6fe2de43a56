#pragma once
// Heights that look as if they meant no data, where nobody has said so.

#include <cstdint>
#include <string>
#include <vector>

#include "ingest/mosaic/source.hpp"

namespace talus {

/// Where samples of exactly 0 have neighbours that are not 0. At a coast these are mostly low, around holes mostly not.
struct ZeroEdges {
  std::uint64_t all = 0, steep = 0;  ///< neighbours, and those of them that lie far from 0
};
/// Adds the edges between samples within `own`.
/// codes are heights in whole or other numbers of `metres_per_code`
void count_zero_edges(const Window& window, GridRect own, double metres_per_code, ZeroEdges& edges);

/// Sentences; none where nothing is doubtful. Heights in the vertical unit.
///
/// all_declare  every input declares a void value, so that InputOptions::nodata is for none of them
[[nodiscard]] std::vector<std::string> void_doubts(double minimum, double maximum, const ZeroEdges& edges,
                                                   const std::string& unit, bool all_declare);

}  // namespace talus
