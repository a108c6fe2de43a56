#include "engine/quadtree/extent_border.hpp"

#include <algorithm>

#include "engine/quadtree/border.hpp"

namespace talus {
namespace {

constexpr auto kRowByRow = [](GridPoint a, GridPoint b) { return a.row != b.row ? a.row < b.row : a.col < b.col; };

}  // namespace

ExtentBorder::ExtentBorder(GridRect extent) : extent_(extent), vertices_(border_vertices(extent, root_side(extent))) {
  std::sort(vertices_.begin(), vertices_.end(), kRowByRow);
}

bool ExtentBorder::contains(GridPoint p) const {
  // All vertices that the border needs are near it, so most others need no search.
  return is_near_border(p, extent_) && std::binary_search(vertices_.begin(), vertices_.end(), p, kRowByRow);
}

bool ExtentBorder::is_near(GridRect rect) const {
  // Parents lie one spacing away: all those below 64 together less than 128.
  constexpr std::int32_t kReach = 128;
  return !extent_.contains({rect.first.col - kReach, rect.first.row - kReach}) ||
         !extent_.contains({rect.last.col + kReach, rect.last.row + kReach});
}

}  // namespace talus
