#pragma once
// Heights at points and along lines: Snapshot::height, heights and profile.

#include <optional>
#include <span>

#include "query/surface/surface.hpp"

namespace talus {

/// Interpolates between samples. `out` is as long as `points`.
/// fails  unsupported: a database that keeps only the vertices for a tolerance
[[nodiscard]] QueryCost sampled_heights(const StoredPages& pages, std::span<const Position> points,
                                        std::span<std::optional<double>> out);
/// Heights of the surface at a tolerance.
[[nodiscard]] QueryCost surface_heights(const StoredPages& pages, const ExtentBorder& border, Metres tolerance,
                                        std::span<const Position> points, std::span<std::optional<double>> out);
/// The surface along a line.
[[nodiscard]] Profile profile(const StoredPages& pages, const ExtentBorder& border, std::span<const Position> line,
                              Metres tolerance);

}  // namespace talus
