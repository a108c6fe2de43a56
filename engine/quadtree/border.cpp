#include "engine/quadtree/border.hpp"

#include <algorithm>

#include "engine/quadtree/scattered_vertices.hpp"

namespace talus {
namespace {

std::int32_t lowest_bit(std::int32_t v) { return v == 0 ? kRootSpacing : v & -v; }

/// place(v) is the grid point at position v of a side along the line `fixed`.
template <class Place, class Take>
void cut_side(std::int32_t fixed, std::int32_t from, std::int32_t to, Place&& place, Take&& take) {
  for (std::int32_t at = from; at < to;) {
    std::int32_t length = std::min({lowest_bit(fixed), lowest_bit(at), kLongestBorderEdge});
    while (length > to - at) length /= 2;
    // Exactly one end has exactly one odd coordinate, in units of `length`: on an even line the odd end, on an odd line
    // the even end.
    const bool start_odd = (at / length & 1) != 0, line_odd = (fixed / length & 1) != 0;
    take(place(start_odd != line_odd ? at : at + length));
    at += length;
  }
}

}  // namespace

std::vector<GridPoint> border_vertices(GridRect region, std::int32_t root) {
  ScatteredVertices found;
  const auto take = [&](GridPoint p) { found.insert(p); };
  const auto& [first, last] = region;
  for (const std::int32_t row : {first.row, last.row}) {
    cut_side(
        row, first.col, last.col,
        [&](std::int32_t v) {
          return GridPoint{v, row};
        },
        take);
  }
  for (const std::int32_t col : {first.col, last.col}) {
    cut_side(
        col, first.row, last.row,
        [&](std::int32_t v) {
          return GridPoint{col, v};
        },
        take);
  }
  for (const GridPoint corner : {first, last, GridPoint{first.col, last.row}, GridPoint{last.col, first.row}})
    take(corner);

  for (int shift = 0; std::int64_t{1} << shift < root; ++shift) {  // root corners have no parents
    for (const bool centres : {false, true}) {
      found.for_each_of_level(shift, centres, [&](GridPoint p) {
        for (const GridPoint parent : diamond(p).apexes) take(parent);
      });
    }
  }
  std::vector<GridPoint> inside;
  found.for_each([&](GridPoint p) {
    if (region.contains(p)) inside.push_back(p);
  });
  return inside;
}

}  // namespace talus
