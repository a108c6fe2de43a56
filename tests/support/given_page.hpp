#pragma once
// A decoded page as one that can be encoded again.

#include "engine/page/page.hpp"

namespace talus::support {

/// Its heights, and the smallest codes that are not below its errors.
inline Page given_page(const Page& decoded, const CodeDistance& distance) {
  Page page = decoded;
  page.heights.resize(page.grid.size());
  page.errors.resize(page.grid.size());
  for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
    page.heights[i] = decoded.height(i);
    page.errors[i] = page.is_own(p) ? decoded.error(i, distance) : ErrorCode{0};
  });
  page.is_dense = false;
  page.squares.clear();
  page.coded.clear();
  page.eighths.clear();
  page.distances.clear();
  return page;
}

}  // namespace talus::support
