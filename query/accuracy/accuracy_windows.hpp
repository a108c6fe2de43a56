#pragma once
// Chooses windows that represent a large region.

#include <cstdint>
#include <optional>
#include <vector>

#include "talus/database.hpp"

namespace talus {

struct AskedWindows {
  std::vector<GridRect> windows;
  bool is_whole = true;
  std::uint64_t places = 1, places_with_terrain = 1;
  Metres terrain;
};

/// The region, or windows spread evenly over its places with terrain. Always the same for the same database.
///
/// is_named  the caller named the region, so a larger one is still measured whole
/// side      samples per side of a window, if the caller chooses
/// fails     invalid_argument: the region has no triangle
[[nodiscard]] AskedWindows windows_of(const Snapshot& now, GridRect region, bool is_named,
                                      std::optional<std::int32_t> side);

}  // namespace talus
