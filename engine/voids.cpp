#include "engine/voids.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

std::size_t index_in(GridRect extent, GridPoint p) {
  return static_cast<std::size_t>((std::int64_t{p.row} - extent.first.row) * extent.cols() +
                                  (std::int64_t{p.col} - extent.first.col));
}

/// visit(index) for each valid sample of a vertex's diamond.
template <class Visit>
void in_diamond(GridRect extent, std::span<const std::uint8_t> valid, GridPoint vertex, Visit&& visit) {
  for (int side = 0; side < 2; ++side) {
    const HalfDiamond t = half_diamond(vertex, side);
    for (std::int32_t row = std::max(t.top(), extent.first.row); row <= std::min(t.bottom(), extent.last.row); ++row) {
      const auto [lo, hi] = t.columns(row);
      for (std::int32_t col = std::max(lo, extent.first.col); col <= std::min(hi, extent.last.col); ++col) {
        const std::size_t i = index_in(extent, {col, row});
        if (valid[i]) visit(i);
      }
    }
  }
}

/// visit(index) for each valid sample at most `reach` columns and rows away: a root corner has no diamond.
template <class Visit>
void around(GridRect extent, std::span<const std::uint8_t> valid, GridPoint p, std::int32_t reach, Visit&& visit) {
  for (std::int32_t row = std::max(p.row - reach, extent.first.row); row <= std::min(p.row + reach, extent.last.row);
       ++row) {
    for (std::int32_t col = std::max(p.col - reach, extent.first.col); col <= std::min(p.col + reach, extent.last.col);
         ++col) {
      const std::size_t i = index_in(extent, {col, row});
      if (valid[i]) visit(i);
    }
  }
}

/// The height nearest to the middle of the range of those visited, the lower of two; 0 if there are none.
template <class ForEach>
double middle_sample(std::span<const double> heights, ForEach&& for_each) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for_each([&](std::size_t i) {
    lowest = std::min(lowest, heights[i]);
    highest = std::max(highest, heights[i]);
  });
  if (lowest > highest) return 0;
  const double middle = lowest + (highest - lowest) / 2;
  double nearest = lowest;
  for_each([&](std::size_t i) {
    const double now = std::abs(heights[i] - middle), best = std::abs(nearest - middle);
    if (now < best || (now == best && heights[i] < nearest)) nearest = heights[i];
  });
  return nearest;
}

}  // namespace

VoidMap::VoidMap(GridRect extent, std::span<const std::uint8_t> valid)
    : extent_(extent), valid_(valid), halves_(extent, 0) {
  const auto settle = [&](GridPoint p) {
    const auto t = apex_triangles(p);
    // A half holds what its two children hold; they have the vertex at their right angle.
    const auto both = [&](std::size_t first) { return triangle(t[first]) | triangle(t[first + 1]); };
    halves_[p] = static_cast<std::uint8_t>(both(0) | both(2) << 2);
  };
  for (int shift = 0; shift < halves_.levels(); ++shift) {
    halves_.for_each(shift, false, settle);
    halves_.for_each(shift, true, settle);
  }
}

Holds VoidMap::finest(Triangle t) const {
  if (!extent_.contains(t.apex) || !extent_.contains(t.left) || !extent_.contains(t.right)) return kNothing;
  const bool valid =
      valid_[index_in(extent_, t.apex)] && valid_[index_in(extent_, t.left)] && valid_[index_in(extent_, t.right)];
  return valid ? kData : kVoid;
}

Holds VoidMap::triangle(Triangle t) const {
  if (spacing(t.apex) == 1 && !is_centre(t.apex)) return finest(t);
  const GridPoint split = midpoint(t.left, t.right);
  if (!halves_.holds(split)) return kNothing;  // farther out than any ancestor of data
  return half(split, diamond(split).apexes[0] == t.apex ? 0 : 1);
}

std::uint8_t VoidMap::apex_triangles_with_data(GridPoint vertex) const {
  const auto triangles = apex_triangles(vertex);
  std::uint8_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if ((triangle(triangles[i]) & kData) != 0) bits = static_cast<std::uint8_t>(bits | 1u << i);
  }
  return bits;
}

void fill_voids(GridRect extent, std::span<const std::uint8_t> valid, const VoidMap& voids, std::span<double> heights) {
  for (std::int32_t row = extent.first.row; row <= extent.last.row; ++row) {
    for (std::int32_t col = extent.first.col; col <= extent.last.col; ++col) {
      const GridPoint p{col, row};
      const std::size_t here = index_in(extent, p);
      if (valid[here]) continue;
      heights[here] = 0;
      if (spacing(p) == kRootSpacing) {
        for (std::int32_t reach = 16; heights[here] == 0 && reach < 2 * root_side(extent); reach *= 2) {
          heights[here] = middle_sample(heights, [&](auto&& visit) { around(extent, valid, p, reach, visit); });
        }
      } else if (voids.apex_triangles_with_data(p) != 0) {
        heights[here] = middle_sample(heights, [&](auto&& visit) { in_diamond(extent, valid, p, visit); });
      }
    }
  }
}

}  // namespace talus
