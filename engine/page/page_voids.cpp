#include "engine/page/page_voids.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "engine/page/page.hpp"
#include "engine/quadtree/apex_halves.hpp"

namespace talus {
namespace {

constexpr int kBlock = 8;
enum BlockKind : std::uint8_t { kAllData = 0, kMixedBlock = 1, kAllVoid = 2 };
constexpr int kBlockContexts = 9;  ///< by the kinds of the western and northern block

/// Visits the blocks; code_block(kind context, block) and code_bit(guess, context, sample) read or write.
template <class CodeBlock, class CodeBit>
void walk_blocks(const PageGrid& grid, std::span<const std::uint8_t> valid, CodeBlock&& code_block,
                 CodeBit&& code_bit) {
  const int across = (grid.cols + kBlock - 1) / kBlock;
  std::vector<std::uint8_t> above(static_cast<std::size_t>(across), kAllData);
  const auto at = [&](int col, int row) -> unsigned {  // outside the page: valid
    if (col < 0 || row < 0) return 1;
    return valid[grid.index(col, row)];
  };
  for (int row = 0; row < grid.rows; row += kBlock) {
    std::uint8_t west = kAllData;
    for (int col = 0; col < grid.cols; col += kBlock) {
      std::uint8_t& kind = above[static_cast<std::size_t>(col / kBlock)];
      const GridRect block{{col, row}, {std::min(col + kBlock, grid.cols) - 1, std::min(row + kBlock, grid.rows) - 1}};
      kind = west = code_block(west + 3 * kind, block);
      if (kind != kMixedBlock) continue;
      for (int r = row; r <= block.last.row; ++r) {
        for (int c = col; c <= block.last.col; ++c) {
          const unsigned w = at(c - 1, r), n = at(c, r - 1), nw = at(c - 1, r - 1);
          code_bit(w, static_cast<int>(w + 2 * n + 4 * nw), c, r);
        }
      }
    }
  }
}

}  // namespace

void put_voids(const PageGrid& grid, std::span<const std::uint8_t> valid, int context, NumberWriter& out) {
  walk_blocks(
      grid, valid,
      [&](int around, const GridRect& block) {
        std::int64_t data = 0;
        for (int r = block.first.row; r <= block.last.row; ++r) {
          for (int c = block.first.col; c <= block.last.col; ++c) data += valid[grid.index(c, r)];
        }
        const std::uint8_t kind = data == block.samples() ? kAllData : data == 0 ? kAllVoid : kMixedBlock;
        out.put(kind, context + around);
        return kind;
      },
      [&](unsigned guess, int around, int col, int row) {
        out.put(valid[grid.index(col, row)] ^ guess, context + kBlockContexts + around);
      });
}

void get_voids(const PageGrid& grid, std::span<std::uint8_t> valid, int context, NumberReader& in) {
  walk_blocks(
      grid, valid,
      [&](int around, const GridRect& block) {
        const auto kind = static_cast<std::uint8_t>(std::min<std::uint64_t>(in.get(context + around), kAllVoid));
        for (int r = block.first.row; r <= block.last.row; ++r) {
          for (int c = block.first.col; c <= block.last.col; ++c) valid[grid.index(c, r)] = kind == kAllData ? 1 : 0;
        }
        return kind;
      },
      [&](unsigned guess, int around, int col, int row) {
        valid[grid.index(col, row)] =
            static_cast<std::uint8_t>((in.get(context + kBlockContexts + around) ^ guess) & 1);
      });
}

namespace {

/// Guesses covers from the page's voids, finest level first; samples outside the page count as valid.
/// visit(index, guess, inside) returns the true cover. If guesses are right inside the page, it is called only where voids
/// are near.
template <class Visit>
void walk_covers(PageId id, int bands, const PageGrid& grid, std::span<const std::uint8_t> valid, bool inner_follow,
                 std::span<std::uint8_t> covers, Visit&& visit) {
  const auto has = [&](GridPoint p) { return p.col >= 0 && p.row >= 0 && p.col < grid.cols && p.row < grid.rows; };
  const auto in_units = [&](int col, int row) { return GridPoint{grid.first.col + col, grid.first.row + row}; };
  const auto holds_data = [&](GridPoint vertex, Triangle t) {
    const auto local = [&](GridPoint p) { return GridPoint{p.col - grid.first.col, p.row - grid.first.row}; };
    if (spacing(vertex) == 1 && !is_centre(vertex)) {
      for (const GridPoint p : {t.apex, t.left, t.right}) {
        if (has(local(p)) && !valid.empty() && valid[grid.index(local(p).col, local(p).row)] == 0) return false;
      }
      return true;
    }
    const GridPoint split = midpoint(t.left, t.right), here = local(split);
    if (!has(here)) return true;
    const int half = diamond(split).apexes[0] == vertex ? 0 : 2;
    return (covers[grid.index(here.col, here.row)] >> half & 3) != 0;
  };
  const auto guess_at_the_rim = [&](GridPoint vertex) {
    unsigned guess = 0;
    const auto triangles = apex_triangles(vertex);
    for (std::size_t k = 0; k < 4; ++k) guess |= (holds_data(vertex, triangles[k]) ? 1u : 0u) << k;
    return guess;
  };
  // The same if everything lies in the page.
  const auto guess_inside = [&](std::size_t i, GridPoint vertex, int s) -> unsigned {
    const VertexKind kind = kind_of(vertex, s);
    const bool centre = is_centre(kind);
    if (s == 1 && !centre) return valid.empty() ? 15 : finest_apex_triangles(&valid[i], grid.cols, kind);
    const std::uint8_t* at = &covers[i];
    const std::ptrdiff_t step = centre ? s : s / 2;
    const std::array<ApexHalf, 4> triangles = apex_halves(kind);
    unsigned guess = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [c, r, side] = triangles[k];
      guess |= ((at[(r * std::ptrdiff_t{grid.cols} + c) * step] >> (2 * side) & 3) != 0 ? 1u : 0u) << k;
    }
    return guess;
  };
  const bool is_coarsest = id.band == bands - 1;
  const int levels = is_coarsest ? kPageShift : kBandLevels;
  // Bit c of row r is about column c and row r of the page's grid.
  PageGrid here = grid;
  here.first = {0, 0};
  const SquareBits all = present_samples(here), data = valid.empty() ? all : marked_samples(here, valid);
  const SquareBits voids = without(all, data);
  const bool only_near_voids = inner_follow && !is_coarsest;
  std::fill(covers.begin(), covers.end(), only_near_voids ? std::uint8_t{15} : std::uint8_t{0});
  if (only_near_voids) {
    constexpr int kStep = 1 << kBandLevels;
    for (int row = -grid.first.row & (kStep - 1); row < grid.rows; row += kStep) {
      for (int col = -grid.first.col & (kStep - 1); col < grid.cols; col += kStep) covers[grid.index(col, row)] = 0;
    }
  }
  // Within s columns and rows.
  SquareBits near_voids = voids, near_data = data;
  const auto settle = [&](int col, int row, int s) {
    const std::size_t i = grid.index(col, row);
    const bool inside = col >= s && row >= s && col + s < grid.cols && row + s < grid.rows;
    unsigned guess = 15;
    if (inside) {
      if (talus::has(near_voids, col, row))
        guess = talus::has(near_data, col, row) ? guess_inside(i, in_units(col, row), s) : 0;
    } else if (s < kPageSide) {
      guess = guess_at_the_rim(in_units(col, row));
    }
    covers[i] = visit(i, static_cast<std::uint8_t>(guess), inside);
  };
  for (int s = 1; s < 1 << levels; s *= 2) {
    for (int reach = s / 2; reach < s; ++reach) near_voids = grown(near_voids), near_data = grown(near_data);
    for (const bool centres : {false, true}) {
      for (int row = -grid.first.row & (s - 1); row < grid.rows; row += s) {
        const bool row_odd = ((grid.first.row + row) & s) != 0;
        if (centres && !row_odd) continue;
        const int phase = centres || !row_odd ? s : 0, first = (phase - grid.first.col) & (2 * s - 1);
        const bool is_rim = !only_near_voids || row < s || row + s >= grid.rows;
        for (int col = first; col < grid.cols; col += 2 * s) {
          if (is_rim || col < s || col + s >= grid.cols || talus::has(near_voids, col, row)) settle(col, row, s);
        }
      }
    }
  }
  if (levels < kPageShift) return;
  for (int row = -grid.first.row & (kPageSide - 1); row < grid.rows; row += kPageSide) {
    for (int col = -grid.first.col & (kPageSide - 1); col < grid.cols; col += kPageSide) settle(col, row, kPageSide);
  }
}

}  // namespace

bool put_covers(PageId id, int bands, const PageGrid& grid, std::span<const std::uint8_t> valid,
                std::span<const std::uint8_t> covers, int context, NumberWriter& out) {
  struct Change {
    std::uint8_t bits;
    bool inside;
  };
  std::vector<Change> changes;
  changes.reserve(covers.size());
  bool inner_follow = true;
  std::vector<std::uint8_t> settled(covers.size());
  walk_covers(id, bands, grid, valid, false, settled, [&](std::size_t i, std::uint8_t guess, bool inside) {
    changes.push_back({static_cast<std::uint8_t>(covers[i] ^ guess), inside});
    if (inside && covers[i] != guess) inner_follow = false;
    return covers[i];
  });
  for (const Change& change : changes) {
    if (!inner_follow || !change.inside) out.put(change.bits, context + (change.inside ? 0 : 1));
  }
  return inner_follow;
}

bool get_covers(PageId id, int bands, const PageGrid& grid, std::span<const std::uint8_t> valid, bool inner_follow,
                std::span<std::uint8_t> covers, int context, NumberReader& in) {
  bool possible = true;
  walk_covers(id, bands, grid, valid, inner_follow, covers, [&](std::size_t, std::uint8_t guess, bool inside) {
    if (inner_follow && inside) return guess;
    const std::uint64_t change = in.get(context + (inside ? 0 : 1));
    possible = possible && change <= 15;
    return static_cast<std::uint8_t>((change ^ guess) & 15);
  });
  return possible;
}

}  // namespace talus
