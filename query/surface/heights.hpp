#pragma once
// Heights at points. See Snapshot::height and Snapshot::heights.

#include <optional>
#include <span>

#include "query/surface/surface.hpp"

namespace talus {

/// Between the samples around. `out` has as many places as there are points.
/// fails  unsupported: a database that keeps the vertices of a tolerance only
[[nodiscard]] QueryCost sampled_heights(const StoredPages& pages, std::span<const Position> points,
                                        std::span<std::optional<double>> out);
/// Of the surface at a tolerance.
[[nodiscard]] QueryCost surface_heights(const StoredPages& pages, const ExtentBorder& border, Metres tolerance,
                                        std::span<const Position> points, std::span<std::optional<double>> out);

}  // namespace talus
