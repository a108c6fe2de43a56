#include "engine/quadtree/construction.hpp"

#include <algorithm>
#include <bit>
#include <span>

#include "engine/machine/cpu.hpp"
#include "engine/quadtree/scattered_vertices.hpp"

namespace talus {
namespace {

/// Up to this spacing a word of 64 columns has the same pattern of columns and diagonals everywhere.
constexpr std::int32_t kWordSpacing = 16;

TALUS_INLINE std::size_t members_of(VertexMask& mask) {
  std::size_t count = 0;
  for (std::int32_t row = mask.region().first.row; row <= mask.region().last.row; ++row) {
    for (const std::uint64_t word : mask.row_words(row)) count += static_cast<std::size_t>(std::popcount(word));
  }
  return count;
}
TALUS_POPCNT std::size_t members_popcnt(VertexMask& mask) { return members_of(mask); }
std::size_t members(VertexMask& mask) { return has_popcnt() ? members_popcnt(mask) : members_of(mask); }

/// Goes level by level: side midpoints first, because their parents are centres of the same level, then centres. So a
/// vertex is visited after everything that can mark it. Marked vertices outside the region go to a list; there are
/// about as many as the region's sides are long.
class Sweep {
 public:
  Sweep(VertexMask& vertices, std::int32_t root) : vertices_(vertices), region_(vertices.region()), root_(root) {}

  void run() {
    for (int shift = 0; std::int64_t{1} << shift < root_; ++shift) {
      const std::int32_t s = std::int32_t{1} << shift;
      for (const bool centres : {false, true}) {
        if (s <= kWordSpacing) {
          mark_by_words(s, centres);
          mark_beyond(s, centres);
        } else {
          mark_by_points(s, centres, region_);
        }
        beyond_.for_each_of_level(shift, centres, [&](GridPoint p) { mark_parents(p); });
      }
    }
  }

 private:
  void mark_parents(GridPoint p) {
    for (const GridPoint parent : diamond(p).apexes) {
      region_.contains(parent) ? vertices_.insert(parent) : beyond_.insert(parent);
    }
  }

  static std::int32_t up(std::int32_t v, std::int32_t s) { return (v + s - 1) & -s; }

  /// Marks the parents of the vertices in `rect`, one by one.
  void mark_by_points(std::int32_t s, bool centres, GridRect rect) {
    for (std::int32_t row = up(rect.first.row, s); row <= rect.last.row; row += s) {
      const bool row_odd = (row & s) != 0;
      if (centres && !row_odd) continue;
      std::int32_t col = up(rect.first.col, s);
      if (((col & s) != 0) != (centres || !row_odd)) col += s;
      for (; col <= rect.last.col; col += 2 * s) {
        if (vertices_.contains({col, row})) mark_parents({col, row});
      }
    }
  }

  /// Marks parents outside the region: only vertices within one spacing of a side have any.
  void mark_beyond(std::int32_t s, bool centres) {
    const auto& [first, last] = region_;
    const GridPoint inner_first{std::min(last.col, first.col + s - 1), std::min(last.row, first.row + s - 1)};
    const GridPoint inner_last{std::max(first.col, last.col - s + 1), std::max(first.row, last.row - s + 1)};
    mark_by_points(s, centres, {first, {last.col, inner_first.row}});
    mark_by_points(s, centres, {{first.col, inner_last.row}, last});
    mark_by_points(s, centres, {first, {inner_first.col, last.row}});
    mark_by_points(s, centres, {{inner_last.col, first.row}, last});
  }

  /// Marks the parents inside the region, 64 columns at once.
  void mark_by_words(std::int32_t s, bool centres) {
    const std::uint64_t even = columns(0, 2 * s), odd = columns(s, 2 * s);
    const std::uint64_t west_even = columns(s, 4 * s), west_odd = columns(3 * s, 4 * s);  // centres: col - s over 2s
    for (std::int32_t row = up(region_.first.row, s); row <= region_.last.row; row += s) {
      const bool row_odd = (row & s) != 0;
      if (centres) {
        if (!row_odd) continue;
        // The parents are two of the four corners: see diamond().
        const bool north_even = ((row - s) & (2 * s)) == 0;
        const std::uint64_t falling = north_even ? west_even : west_odd, rising = north_even ? west_odd : west_even;
        mark(row, falling, row - s, s);
        mark(row, falling, row + s, -s);
        mark(row, rising, row - s, -s);
        mark(row, rising, row + s, s);
      } else if (row_odd) {
        mark(row, even, row, -s);
        mark(row, even, row, s);
      } else {
        mark(row, odd, row - s, 0);
        mark(row, odd, row + s, 0);
      }
    }
  }

  /// The columns of a word with this remainder; the divisor is a power of two, at most 64.
  [[nodiscard]] std::uint64_t columns(std::int32_t remainder, std::int32_t divisor) const {
    std::uint64_t found = 0;
    for (std::int32_t i = 0; i < 64; ++i) {
      if (((region_.first.col + i) & (divisor - 1)) == remainder) found |= std::uint64_t{1} << i;
    }
    return found;
  }

  /// Marks in row `to` the points `east` columns from the members of row `from` in `pattern`. It never reads what it
  /// wrote: children and parents have different columns.
  void mark(std::int32_t from, std::uint64_t pattern, std::int32_t to, std::int32_t east) {
    if (to < region_.first.row || to > region_.last.row) return;
    const std::span<const std::uint64_t> members_from = vertices_.row_words(from);
    const std::span<std::uint64_t> parents = vertices_.row_words(to);
    std::uint64_t carry = 0;
    if (east == 0) {
      for (std::size_t w = 0; w < parents.size(); ++w) parents[w] |= members_from[w] & pattern;
    } else if (east > 0) {
      for (std::size_t w = 0; w < parents.size(); ++w) {
        const std::uint64_t found = members_from[w] & pattern;
        parents[w] |= found << east | carry;
        carry = found >> (64 - east);
      }
      if (region_.cols() % 64 != 0) parents.back() &= (std::uint64_t{1} << region_.cols() % 64) - 1;
    } else {
      for (std::size_t w = parents.size(); w-- > 0;) {
        const std::uint64_t found = members_from[w] & pattern;
        parents[w] |= found >> -east | carry;
        carry = found << (64 + east);
      }
    }
  }

  VertexMask& vertices_;
  GridRect region_;
  std::int32_t root_;
  ScatteredVertices beyond_;
};

}  // namespace

std::size_t close_bottom_up(VertexMask& vertices, std::int32_t root) {
  const std::size_t before = members(vertices);
  Sweep(vertices, root).run();
  return members(vertices) - before;
}

namespace detail {

bool ResolvedSet::is_new(GridPoint p) {
  if (!inside_.region().contains(p)) {
    return beyond_.insert(std::uint64_t{static_cast<std::uint32_t>(p.row)} << 32 | static_cast<std::uint32_t>(p.col))
        .second;
  }
  if (inside_.contains(p)) return false;
  inside_.insert(p);
  return true;
}

void ResolvedSet::insert(GridPoint p) {
  if (!is_new(p) || spacing(p) >= root_) return;
  for (const GridPoint parent : diamond(p).apexes) insert(parent);
}

}  // namespace detail
}  // namespace talus
