#include "engine/voids.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

std::size_t index_in(GridRect extent, GridPoint p) {
  return static_cast<std::size_t>((std::int64_t{p.row} - extent.first.row) * extent.cols() +
                                  (std::int64_t{p.col} - extent.first.col));
}

/// visit(index) for each valid sample at most `reach` columns and rows away.
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

/// The height nearest to the middle of the range of those visited, the lower of two; none if there are none.
template <class Code, class ForEach>
std::optional<Code> middle_sample(std::span<const Code> heights, ForEach&& for_each) {
  bool any = false;
  Code lowest{}, highest{};
  for_each([&](std::size_t i) {
    lowest = any ? std::min(lowest, heights[i]) : heights[i];
    highest = any ? std::max(highest, heights[i]) : heights[i];
    any = true;
  });
  if (!any) return std::nullopt;
  const double middle = static_cast<double>(lowest) + (static_cast<double>(highest) - static_cast<double>(lowest)) / 2;
  Code nearest = lowest;
  for_each([&](std::size_t i) {
    const double now = std::abs(static_cast<double>(heights[i]) - middle);
    const double best = std::abs(static_cast<double>(nearest) - middle);
    if (now < best || (now == best && heights[i] < nearest)) nearest = heights[i];
  });
  return nearest;
}

template <class Code>
std::optional<Code> fill_at(GridRect extent, std::span<const std::uint8_t> valid, std::span<const Code> heights,
                            GridPoint p) {
  for (std::int32_t reach = 1; reach <= kFillReach; reach *= 2) {
    const auto found = middle_sample(heights, [&](auto&& visit) { around(extent, valid, p, reach, visit); });
    if (found) return found;
  }
  return std::nullopt;
}

}  // namespace

VoidMap::VoidMap(GridRect extent, std::span<const std::uint8_t> valid, int levels)
    : extent_(extent), valid_(valid), halves_(extent, levels, 0) {
  const auto settle = [&](GridPoint p) {
    const auto t = apex_triangles(p);
    // A half holds what its two children hold; they have the vertex at their right angle.
    const auto both = [&](std::size_t first) { return triangle(t[first]) | triangle(t[first + 1]); };
    const int first = inside(half_diamond(p, 0), extent_) ? both(0) : kNothing;
    const int second = inside(half_diamond(p, 1), extent_) ? both(2) : kNothing;
    halves_[p] = static_cast<std::uint8_t>(first | second << 2);
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

std::optional<double> fill_of(GridRect extent, std::span<const std::uint8_t> valid, const CodeSpan& heights,
                              GridPoint p) {
  return std::visit(
      [&](auto codes) -> std::optional<double> {
        const auto fill = fill_at(extent, valid, codes, p);
        return fill ? std::optional(static_cast<double>(*fill)) : std::nullopt;
      },
      heights);
}

void fill_voids(GridRect extent, std::span<const std::uint8_t> valid, const VoidMap& voids, GridRect within,
                Codes& heights) {
  std::visit(
      [&](auto& codes) {
        using Code = typename std::decay_t<decltype(codes)>::value_type;
        for (std::int32_t row = std::max(within.first.row, extent.first.row);
             row <= std::min(within.last.row, extent.last.row); ++row) {
          for (std::int32_t col = std::max(within.first.col, extent.first.col);
               col <= std::min(within.last.col, extent.last.col); ++col) {
            const GridPoint p{col, row};
            const std::size_t here = index_in(extent, p);
            if (valid[here]) continue;
            const bool needed = height_in_tree(p) >= voids.levels() || voids.apex_triangles_with_data(p) != 0;
            codes[here] = needed ? fill_at(extent, valid, std::span<const Code>(codes), p).value_or(Code{}) : Code{};
          }
        }
      },
      heights);
}

}  // namespace talus
