#include "engine/page/page_layout.hpp"

#include <algorithm>

namespace talus {

std::vector<PageId> pages_of_band(int band, GridRect extent) {
  const PageId first = page_of(extent.first, band), last = page_of(extent.last, band);
  std::vector<PageId> pages;
  for (std::int32_t y = first.y; y <= last.y; ++y) {
    for (std::int32_t x = first.x; x <= last.x; ++x) pages.push_back({band, x, y});
  }
  std::sort(pages.begin(), pages.end(), [](PageId a, PageId b) { return curve_position(a) < curve_position(b); });
  return pages;
}

}  // namespace talus
