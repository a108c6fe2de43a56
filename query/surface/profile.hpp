#pragma once
// The surface along a line: Snapshot::profile.

#include <span>

#include "query/surface/surface.hpp"

namespace talus {

[[nodiscard]] Profile profile(const StoredPages& pages, const ExtentBorder& border, std::span<const Position> line,
                              Metres tolerance);

}  // namespace talus
