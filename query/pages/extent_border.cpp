#include "query/pages/extent_border.hpp"

#include <algorithm>

#include "engine/page/page_layout.hpp"
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

}  // namespace talus
