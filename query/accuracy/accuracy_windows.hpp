#pragma once
// Which windows stand for a region that is too large to be asked about again and again.

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

/// The region itself, or windows spread evenly over the places in it that hold terrain. The same for the same database.
///
/// is_named  the caller named the region, which is then asked about itself up to a larger size
/// side      samples a side of windows, if the caller wants them
/// fails     invalid_argument: nothing there has a triangle
[[nodiscard]] AskedWindows windows_of(const Snapshot& now, GridRect region, bool is_named,
                                      std::optional<std::int32_t> side);

}  // namespace talus
