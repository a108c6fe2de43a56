#include "engine/error/voids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/quadtree/apex_halves.hpp"
#include "engine/quadtree/rect.hpp"

namespace talus {
namespace {

/// The samples of an extent within `reach` columns and rows.
GridRect around(GridRect extent, GridPoint p, std::int32_t reach) { return common(grown({p, p}, reach), extent); }

/// The valid sample nearest to the middle of the range of a rectangle, the lower of two; empty: none is valid.
template <class Code>
std::optional<Code> middle_sample(GridRect extent, std::span<const std::uint8_t> valid, std::span<const Code> heights,
                                  GridRect part) {
  const auto width = static_cast<std::size_t>(part.cols());
  std::array<Code, (2 * kFillReach + 1) * (2 * kFillReach + 1)> found;
  std::size_t count = 0;
  for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
    const std::size_t start = index_in(extent, {part.first.col, row});
    if (std::memchr(&valid[start], 1, width) == nullptr) continue;
    for (std::size_t i = start; i < start + width; ++i) {
      found[count] = heights[i];
      count += valid[i];
    }
  }
  if (count == 0) return std::nullopt;
  const auto [lowest, highest] = std::minmax_element(found.begin(), found.begin() + count);
  const double middle =
      static_cast<double>(*lowest) + (static_cast<double>(*highest) - static_cast<double>(*lowest)) / 2;
  Code nearest = *lowest;
  double best = std::abs(static_cast<double>(nearest) - middle);
  for (std::size_t i = 0; i < count; ++i) {
    const double now = std::abs(static_cast<double>(found[i]) - middle);
    if (now < best || (now == best && found[i] < nearest)) {
      nearest = found[i];
      best = now;
    }
  }
  return nearest;
}

template <class Code>
std::optional<Code> fill_at(GridRect extent, std::span<const std::uint8_t> valid, std::span<const Code> heights,
                            GridPoint p) {
  for (std::int32_t reach = 1; reach <= kFillReach; reach *= 2) {
    const auto found = middle_sample(extent, valid, heights, around(extent, p, reach));
    if (found) return found;
  }
  return std::nullopt;
}

}  // namespace

namespace {

constexpr std::uint8_t kFirst = 3, kSecond = 12;  // bits of side 0 and side 1

/// Computes what halves hold, level by level and row by row. A half holds what its two children hold. Those of a side
/// midpoint are split at centres one level finer, those of a centre at the side midpoints around it. A half that leaves
/// the extent holds nothing.
class HalvesOfRows {
 public:
  using Units = LevelGrid<std::uint8_t>::Units;
  HalvesOfRows(GridRect extent, std::span<const std::uint8_t> valid) : extent_(extent), valid_(valid) {}

  void settle(int shift, const Units& level, const Units& finer) {
    first_ = {-(-extent_.first.col >> shift), -(-extent_.first.row >> shift)};  // rounded up
    last_ = {extent_.last.col >> shift, extent_.last.row >> shift};
    for (std::int32_t row = first_.row; row <= last_.row; ++row) {
      if (shift == 0) {
        finest_sides(level, row);
      } else {
        sides(level, finer, row);
      }
      forget_those_that_leave(level, row);
    }
    for (std::int32_t row = first_.row + 1; row < last_.row; ++row) {
      if ((row & 1) != 0) centres(level, row);
    }
  }

 private:
  /// What a half of two finest triangles holds; each is 1 (valid) or 0.
  static constexpr std::uint8_t held(unsigned one, unsigned other) {
    return static_cast<std::uint8_t>((one | other) | ((one & other) ^ 1u) << 1);
  }
  /// 0xff for columns of this parity, else 0.
  static constexpr std::uint8_t only(std::int32_t col, int parity) {
    return static_cast<std::uint8_t>(((col ^ parity) & 1) - 1);
  }

  void finest_sides(const Units& level, std::int32_t row) const {
    const std::ptrdiff_t cols = extent_.cols();
    const std::uint8_t* here = &valid_[index_in(extent_, {extent_.first.col, row})];
    const std::uint8_t* above = row > extent_.first.row ? here - cols : here;
    const std::uint8_t* below = row < extent_.last.row ? here + cols : here;
    std::uint8_t* to = &level.at(extent_.first.col, row);
    const int parity = (row & 1) != 0 ? 0 : 1;  // parity of the columns with side midpoints
    const std::int32_t first = extent_.first.col;
    const auto settle = [&](std::ptrdiff_t i, unsigned west, unsigned east) {
      const unsigned v = here[i], n = above[i], s = below[i];
      const auto level_side =
          static_cast<unsigned>(held(v & n & west, v & n & east) | held(v & s & west, v & s & east) << 2);
      const auto upright =
          static_cast<unsigned>(held(v & west & n, v & west & s) | held(v & east & n, v & east & s) << 2);
      to[i] = static_cast<std::uint8_t>((parity == 1 ? level_side : upright) &
                                        only(first + static_cast<std::int32_t>(i), parity));
    };
    for (std::ptrdiff_t i = 1; i < cols - 1; ++i) settle(i, here[i - 1], here[i + 1]);
    if (cols > 1) settle(0, here[0], here[1]), settle(cols - 1, here[cols - 2], here[cols - 1]);
  }

  void sides(const Units& level, const Units& finer, std::int32_t row) const {
    const std::uint8_t* above = &finer.at(0, 2 * row - 1);
    const std::uint8_t* below = &finer.at(0, 2 * row + 1);
    std::uint8_t* to = &level.at(0, row);
    const bool upright = (row & 1) != 0;
    for (std::int32_t col = first_.col + ((first_.col ^ (upright ? 0 : 1)) & 1); col <= last_.col; col += 2) {
      const std::ptrdiff_t x = 2 * std::ptrdiff_t{col};
      const unsigned nw = above[x - 1] >> 2, ne = above[x + 1] >> 2, sw = below[x - 1] & kFirst,
                     se = below[x + 1] & kFirst;
      to[col] = static_cast<std::uint8_t>(upright ? (nw | sw) | (ne | se) << 2 : (nw | ne) | (sw | se) << 2);
    }
  }

  void forget_those_that_leave(const Units& level, std::int32_t row) const {
    if (first_.col > last_.col) return;
    std::uint8_t* to = &level.at(0, row);
    if ((row & 1) != 0) {
      for (std::int32_t col = first_.col; col <= last_.col; ++col) {
        if (row == first_.row || row == last_.row) to[col] = 0;
      }
      to[first_.col] &= kSecond;
      to[last_.col] &= kFirst;
    } else {
      to[first_.col] = to[last_.col] = 0;
      if (row != first_.row && row != last_.row) return;
      for (std::int32_t col = first_.col; col <= last_.col; ++col) {
        if (row == first_.row) to[col] &= kSecond;
        if (row == last_.row) to[col] &= kFirst;
      }
    }
  }

  void centres(const Units& level, std::int32_t row) const {
    std::uint8_t* here = &level.at(0, row);
    const std::uint8_t* above = &level.at(0, row - 1);
    const std::uint8_t* below = &level.at(0, row + 1);
    for (std::int32_t col = (first_.col + 1) | 1; col < last_.col; col += 2) {
      const unsigned n = above[col] >> 2, w = here[col - 1] >> 2, e = here[col + 1] & kFirst, s = below[col] & kFirst;
      const bool falls = (((col - 1) ^ (row - 1)) & 2) == 0;
      here[col] = static_cast<std::uint8_t>(falls ? (n | e) | (w | s) << 2 : (n | w) | (s | e) << 2);
    }
  }

  GridRect extent_;
  std::span<const std::uint8_t> valid_;
  GridPoint first_, last_;  // vertices of the level in the extent
};

}  // namespace

VoidMap::VoidMap(GridRect extent, std::span<const std::uint8_t> valid, int levels) : halves_({{0, 0}, {-1, -1}}, 0, 0) {
  reset(extent, valid, levels);
}

void VoidMap::reset(GridRect extent, std::span<const std::uint8_t> valid, int levels) {
  extent_ = extent;
  valid_ = valid;
  halves_.reset(extent, levels, 0);
  HalvesOfRows rows(extent, valid);
  for (int shift = 0; shift < levels; ++shift) {
    rows.settle(shift, halves_.units(shift), shift == 0 ? LevelGrid<std::uint8_t>::Units{} : halves_.units(shift - 1));
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
  if (!halves_.holds(split)) return kNothing;  // outside the reach of all ancestors of data
  return half(split, diamond(split).apexes[0] == t.apex ? 0 : 1);
}

std::uint8_t VoidMap::apex_triangles_with_data(GridPoint vertex) const {
  // Two triangles make up each half: if both halves are all data, or all void, so are the triangles.
  if (halves_.holds(vertex)) {
    const std::uint8_t halves = halves_[vertex];
    if (halves == (kData | kData << 2)) return 15;
    if (halves == (kVoid | kVoid << 2)) return 0;
  }
  const int shift = height_in_tree(vertex);
  const std::int32_t s = std::int32_t{1} << shift;
  std::uint8_t bits = 0;
  if (extent_.contains({vertex.col - s, vertex.row - s}) && extent_.contains({vertex.col + s, vertex.row + s})) {
    const VertexKind kind = kind_of(vertex, s);
    const bool centre = is_centre(kind);
    if (shift == 0 && !centre) {
      return finest_apex_triangles(&valid_[index_in(extent_, vertex)], static_cast<std::ptrdiff_t>(extent_.cols()),
                                   kind);
    }
    const int finer = centre ? shift : shift - 1;  // level of the vertices that split them
    const auto level = halves_.units(finer);
    const std::uint8_t* at = &level.at(vertex.col >> finer, vertex.row >> finer);
    const std::array<ApexHalf, 4> triangles = apex_halves(kind);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [col, row, side] = triangles[i];
      bits = static_cast<std::uint8_t>(bits | (at[row * level.stride + col] >> (2 * side) & kData) << i);
    }
    return bits;
  }
  const auto triangles = apex_triangles(vertex);
  for (std::size_t i = 0; i < 4; ++i) {
    if ((triangle(triangles[i]) & kData) != 0) bits = static_cast<std::uint8_t>(bits | 1u << i);
  }
  return bits;
}

bool has_data_near(GridRect extent, std::span<const std::uint8_t> valid, GridPoint p) {
  const GridRect near = around(extent, p, kFillReach);
  for (std::int32_t row = near.first.row; row <= near.last.row; ++row) {
    const std::size_t start = index_in(extent, {near.first.col, row});
    if (std::memchr(&valid[start], 1, static_cast<std::size_t>(near.cols())) != nullptr) return true;
  }
  return false;
}

namespace {

/// Whether a triangle with data can have this void vertex as a corner. At spacing 1 none can: all finest triangles of
/// the vertex are void.
bool is_needed(GridRect extent, const VoidMap& voids, GridPoint p) {
  const int shift = height_in_tree(p);
  if (shift == 0) return false;
  if (shift >= voids.levels()) return true;
  // Its apex triangles make up both halves, but a half that leaves the extent holds nothing.
  const std::int32_t s = 1 << shift;
  if (extent.contains({p.col - s, p.row - s}) && extent.contains({p.col + s, p.row + s})) {
    return ((voids.half(p, 0) | voids.half(p, 1)) & kData) != 0;
  }
  // Near the side of the extent, smaller triangles with the vertex at an end of the hypotenuse may still lie inside.
  return true;
}

}  // namespace

void fill_voids(GridRect extent, std::span<const std::uint8_t> valid, const VoidMap& voids, GridRect within,
                Codes& heights) {
  const GridRect part = common(within, extent);
  if (part.cols() <= 0) return;
  std::visit(
      [&](auto& codes) {
        using Code = typename std::decay_t<decltype(codes)>::value_type;
        for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
          const std::size_t start = index_in(extent, {part.first.col, row});
          const auto width = static_cast<std::size_t>(part.cols());
          for (std::size_t i = start; i < start + width; ++i) codes[i] = valid[i] != 0 ? codes[i] : Code{};
          if ((row & 1) != 0) continue;
          for (std::int32_t col = part.first.col + (part.first.col & 1); col <= part.last.col; col += 2) {
            const GridPoint p{col, row};
            const std::size_t here = index_in(extent, p);
            if (valid[here] || !is_needed(extent, voids, p)) continue;
            codes[here] = fill_at(extent, valid, std::span<const Code>(codes), p).value_or(Code{});
          }
        }
      },
      heights);
}

}  // namespace talus
