#include "engine/tile/coarse_levels.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace talus {
namespace {

constexpr std::int32_t kTileUnits = kTileSide / kBlockSide;

GridPoint in_samples(GridPoint unit) { return {unit.col * kBlockSide, unit.row * kBlockSide}; }
std::int32_t ceil_unit(std::int32_t v) { return (v + kBlockSide - 1) >> kBlockShift; }

GridRect blocks_of(GridRect extent) {
  return {{(extent.first.col >> kBlockShift) - 1, (extent.first.row >> kBlockShift) - 1},
          {(extent.last.col >> kBlockShift) + 1, (extent.last.row >> kBlockShift) + 1}};
}
GridRect floor_units(GridRect extent) {
  return {{extent.first.col >> kBlockShift, extent.first.row >> kBlockShift},
          {extent.last.col >> kBlockShift, extent.last.row >> kBlockShift}};
}
int coarse_level_count(GridRect extent) {
  int levels = 0;
  while ((std::int32_t{kBlockSide} << levels) < root_side(extent)) ++levels;
  return levels;
}

bool may_touch(const HalfDiamond& t, GridRect r) {
  const std::int32_t first = std::max(t.top(), r.first.row), last = std::min(t.bottom(), r.last.row);
  if (first > last) return false;
  const auto [lo, hi] = t.columns_over(first, last);
  return lo <= r.last.col && hi >= r.first.col;
}

GridRect square_of_block(TileId id, std::int32_t block) {
  return square(
      {id.x * kTileSide + block % kTileBlocks * kBlockSide, id.y * kTileSide + block / kTileBlocks * kBlockSide},
      kBlockSide);
}

std::uint64_t key_of(GridPoint vertex, int side) {
  const auto u = [](std::int32_t v) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)); };
  return (u(vertex.col) << 32 | u(vertex.row)) << 1 ^ static_cast<std::uint64_t>(side) ^ u(vertex.col) >> 31;
}

}  // namespace

/// A half-diamond that no tile could measure: it is larger than a tile, or the fill of a corner was not known there.
struct CoarseLevels::Large {
  HalfDiamond t;
  Plane<double> plane;
  double largest = 0;  ///< the largest distance found so far, in height codes
  BitRange bits;
  // The block that may have the largest distance:
  double best_bound = -1;
  TileId best_tile;
  std::int32_t best_block = 0;
};

CoarseLevels::CoarseLevels(GridRect extent, const CodeDistance& distance, GroundSide ground_side, double void_weight,
                           ErrorRule rule)
    : extent_(extent),
      units_{{ceil_unit(extent.first.col), ceil_unit(extent.first.row)},
             {extent.last.col >> kBlockShift, extent.last.row >> kBlockShift}},
      blocks_(blocks_of(extent)),
      distance_(distance),
      ground_side_(std::move(ground_side)),
      void_weight_(void_weight),
      rule_(std::move(rule)),
      errors_(floor_units(extent), coarse_level_count(extent), 0),
      holds_(floor_units(extent), coarse_level_count(extent), 0) {
  if (is_empty(units_)) units_ = {{0, 0}, {-1, -1}};
  block_errors_.assign(static_cast<std::size_t>(blocks_.samples()), 0);
  block_holds_.assign(block_errors_.size(), 0);
  posts_.assign(static_cast<std::size_t>(units_.samples()), 0);
  post_valid_.assign(posts_.size(), 0);
}

CoarseLevels::~CoarseLevels() = default;

std::size_t CoarseLevels::post(GridPoint p) const {
  return index_in(units_, {p.col >> kBlockShift, p.row >> kBlockShift});
}
bool CoarseLevels::has_block(std::int32_t x, std::int32_t y) const { return blocks_.contains({x, y}); }
std::size_t CoarseLevels::block(std::int32_t x, std::int32_t y) const { return index_in(blocks_, {x, y}); }

ErrorCode CoarseLevels::error(GridPoint p) const {
  const GridPoint unit{p.col >> kBlockShift, p.row >> kBlockShift};
  return height_in_tree(unit) >= errors_.levels() ? kAlwaysSelected : errors_[unit];
}

void CoarseLevels::settle(const ForEachTile& tiles, const ReadBack& read_back) {
  tiles([&](TileId id, const TileSummary& summary) { take(id, summary); });
  hold_large_halves();
  fill_far_voids();
  measure_large(tiles, read_back);
  saturate();
}

void CoarseLevels::take(TileId id, const TileSummary& summary) {
  for (std::int32_t y = 0; y < kTileBlocks; ++y) {
    for (std::int32_t x = 0; x < kTileBlocks; ++x) {
      const auto i = static_cast<std::size_t>(y * kTileBlocks + x);
      const TileRecord::Block& b = summary.record.blocks[i];
      const GridPoint unit{id.x * kTileUnits + x, id.y * kTileUnits + y};
      if (has_block(unit.col, unit.row)) {
        block_errors_[block(unit.col, unit.row)] = b.error;
        block_holds_[block(unit.col, unit.row)] = b.holds;
        if (((b.holds | b.holds >> 2) & kVoid) != 0) has_voids_ = true;
        if (b.has_data) typical_.emplace_back(unit, b.typical);
      }
      if (units_.contains(unit)) {
        posts_[post(in_samples(unit))] = summary.posts[i];
        post_valid_[post(in_samples(unit))] = summary.post_valid[i];
        if (summary.post_valid[i] == 0) has_voids_ = true;
      }
    }
  }
  for (std::int32_t y = 0; y < TileRecord::kAcross; ++y) {
    for (std::int32_t x = 0; x < TileRecord::kAcross; ++x) {
      const auto i = static_cast<std::size_t>(y * TileRecord::kAcross + x);
      const GridPoint unit{id.x * kTileUnits + x, id.y * kTileUnits + y};
      if ((summary.record.holds[i] & TileRecord::kNoFill) != 0 && x < kTileBlocks && y < kTileBlocks)
        without_fill_.push_back(unit);
      if (spacing(unit) >= kTileUnits || !errors_.holds(unit)) continue;
      errors_[unit] = std::max(errors_[unit], summary.record.errors[i]);
      holds_[unit] = static_cast<std::uint8_t>(holds_[unit] | summary.record.holds[i]);
    }
  }
}

// ---- what triangles hold -------------------------------------------------------------------------

Holds CoarseLevels::half(GridPoint unit, int side) const { return static_cast<Holds>(holds_[unit] >> (2 * side) & 3); }

Holds CoarseLevels::triangle(Triangle t) const {
  const GridPoint split = midpoint(t.left, t.right);
  const int side = diamond(split).apexes[0] == t.apex ? 0 : 1;
  if (spacing(split) < kBlockSide) {  // the centre of a block
    const std::int32_t x = split.col >> kBlockShift, y = split.row >> kBlockShift;
    return has_block(x, y) ? static_cast<Holds>(block_holds_[block(x, y)] >> (2 * side) & 3) : kNothing;
  }
  const GridPoint unit{split.col >> kBlockShift, split.row >> kBlockShift};
  return errors_.holds(unit) ? half(unit, side) : kNothing;
}

std::uint8_t CoarseLevels::apex_triangles_with_data(GridPoint p) const {
  const auto triangles = apex_triangles(p);
  std::uint8_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if ((triangle(triangles[i]) & kData) != 0) bits = static_cast<std::uint8_t>(bits | 1u << i);
  }
  return bits;
}

/// A half holds what its two children hold; the children have their right angle at the vertex.
void CoarseLevels::hold_large_halves() {
  for (int shift = kTileShift - kBlockShift; shift < holds_.levels(); ++shift) {
    for (const bool centres : {false, true}) {
      holds_.for_each(shift, centres, [&](GridPoint unit) {
        const auto t = apex_triangles(in_samples(unit));
        const auto both = [&](std::size_t first) { return triangle(t[first]) | triangle(t[first + 1]); };
        holds_[unit] = static_cast<std::uint8_t>(both(0) | both(2) << 2);
      });
    }
  }
}

// ---- voids far from data ---------------------------------------------------------------------------

/// Fills void vertices without data within a tile's reach that a triangle with data can need. Among the nearest blocks
/// with data, it takes the typical height that is nearest to the middle of their range.
void CoarseLevels::fill_far_voids() {
  std::erase_if(without_fill_, [&](GridPoint unit) {
    return !units_.contains(unit) || height_in_tree(unit) >= errors_.levels() ||
           apex_triangles_with_data(in_samples(unit)) == 0;
  });
  if (without_fill_.empty()) return;
  std::sort(typical_.begin(), typical_.end(), [](const auto& a, const auto& b) {
    return std::pair{a.first.row, a.first.col} < std::pair{b.first.row, b.first.col};
  });
  for (const GridPoint unit : without_fill_) {
    double lowest = 0, highest = 0, fill = 0;
    for (std::int32_t reach = 2; reach < 4 * root_side(extent_) / kBlockSide; reach *= 2) {
      const auto for_each_near = [&](auto&& visit) {
        auto at = std::lower_bound(typical_.begin(), typical_.end(), unit.row - reach,
                                   [](const auto& b, std::int32_t row) { return b.first.row < row; });
        for (; at != typical_.end() && at->first.row < unit.row + reach; ++at) {
          if (at->first.col >= unit.col - reach && at->first.col < unit.col + reach) visit(at->second);
        }
      };
      bool any = false;
      for_each_near([&](double h) {
        lowest = any ? std::min(lowest, h) : h;
        highest = any ? std::max(highest, h) : h;
        any = true;
      });
      if (!any) continue;
      const double middle = lowest + (highest - lowest) / 2;
      fill = lowest;
      for_each_near([&](double h) {
        const double now = std::abs(h - middle), best = std::abs(fill - middle);
        if (now < best || (now == best && h < fill)) fill = h;
      });
      break;
    }
    posts_[post(in_samples(unit))] = fill;
  }
}

// ---- errors of halves larger than a tile -----------------------------------------------------------

void CoarseLevels::collect_large() {
  for (int shift = 0; shift < errors_.levels(); ++shift) {
    const bool larger_than_tile = shift >= kTileShift - kBlockShift;
    if (!larger_than_tile && !has_voids_) continue;
    for (const bool centres : {false, true}) {
      errors_.for_each(shift, centres, [&](GridPoint unit) {
        for (const int side : {0, 1}) {
          if (!larger_than_tile && (holds_[unit] & TileRecord::kOpenHalf[side]) == 0) continue;
          if (!larger_than_tile) smallest_shift_ = std::min(smallest_shift_, shift);
          Large half{half_diamond(in_samples(unit), side), {}, 0, {}, -1, {}, 0};
          if (!inside(half.t, extent_) || (this->half(unit, side) & kData) == 0) continue;
          half.plane = plane_of(half.t, [&](GridPoint p) { return height(p); });
          for (const GridPoint p : {half.t.apex, half.t.a, half.t.b}) half.bits.take(height(p));
          large_at_.emplace(key_of(half.t.vertex, side), large_.size());
          large_.push_back(half);
        }
      });
    }
  }
}

/// visit(Large&) for each half that may touch a sample of the tile's own square. Halves lie in squares of side 2s; a
/// tile that begins with such a square has its first samples on the square before, too.
template <class Visit>
void CoarseLevels::for_each_large_touching(TileId id, Visit&& visit) {
  const GridRect own{{id.x * kTileSide, id.y * kTileSide},
                     {id.x * kTileSide + kTileSide - 1, id.y * kTileSide + kTileSide - 1}};
  for (int shift = kBlockShift + smallest_shift_; shift < errors_.levels() + kBlockShift; ++shift) {
    const std::int32_t s = std::int32_t{1} << shift;
    const auto visit_half = [&](GridPoint vertex, GridPoint apex) {
      const int side = diamond(vertex).apexes[0] == apex ? 0 : 1;
      const auto found = large_at_.find(key_of(vertex, side));
      if (found != large_at_.end() && may_touch(large_[found->second].t, own)) visit(large_[found->second]);
    };
    for (std::int32_t by = (own.first.row - 1) >> (shift + 1); by <= own.last.row >> (shift + 1); ++by) {
      for (std::int32_t bx = (own.first.col - 1) >> (shift + 1); bx <= own.last.col >> (shift + 1); ++bx) {
        const GridPoint centre{bx * 2 * s + s, by * 2 * s + s};
        const Diamond d = diamond(centre);
        visit_half(centre, d.apexes[0]);
        visit_half(centre, d.apexes[1]);
        for (const GridPoint side : {GridPoint{centre.col - s, centre.row},
                                     {centre.col + s, centre.row},
                                     {centre.col, centre.row - s},
                                     {centre.col, centre.row + s}}) {
          if (spacing(side) == s) visit_half(side, centre);
        }
      }
    }
  }
}

/// An upper bound of the distance of a block's samples from a half's plane. The fitted plane includes its own rounding;
/// the comparison adds as much again.
static double bound_of(const TileRecord::Block& b, GridRect square, const Plane<double>& plane) {
  constexpr std::int32_t kHalf = kBlockSide / 2;
  const double there = plane.base + plane.down * (square.first.row + kHalf - plane.row) +
                       plane.right * (square.first.col + kHalf - plane.col);
  const double apart = b.middle - there;
  const double tilt = kHalf * (std::abs(b.right - plane.right) + std::abs(b.down - plane.down));
  const double bound = std::max(apart + tilt + b.above, -apart + tilt + b.below);
  return bound + 1e-9 * (1 + std::abs(there) + std::abs(apart) + tilt);
}

void CoarseLevels::bound_in(TileId id, const TileSummary& summary) {
  for_each_large_touching(id, [&](Large& half) {
    for (std::int32_t i = 0; i < kTileBlocks * kTileBlocks; ++i) {
      const TileRecord::Block& b = summary.record.blocks[static_cast<std::size_t>(i)];
      if (!b.has_data) continue;
      const GridRect square = square_of_block(id, i);
      if (!may_touch(half.t, square)) continue;
      half.bits.take(b.bits);
      if (const double bound = bound_of(b, square, half.plane); bound > half.best_bound) {
        half.best_bound = bound;
        half.best_tile = id;
        half.best_block = i;
      }
      const GridPoint p = square.first;
      if (!units_.contains({p.col >> kBlockShift, p.row >> kBlockShift}) || !is_valid(p)) continue;
      if (p.row < half.t.top() || p.row > half.t.bottom()) continue;
      const auto [lo, hi] = half.t.columns(p.row);
      if (p.col < lo || p.col > hi) continue;
      const double at = half.plane.on_row(p.row) + half.plane.right * (p.col - half.plane.col);
      half.largest = std::max(half.largest, std::abs(height(p) - at));
    }
  });
}

void CoarseLevels::look(Large& half, const Page& page, GridRect block) const {
  const HalfDiamond& t = half.t;
  const std::int32_t top = std::max({t.top(), block.first.row, page.grid.first.row});
  const std::int32_t bottom = std::min({t.bottom(), block.last.row, page.grid.first.row + page.grid.rows - 1});
  for (std::int32_t row = top; row <= bottom; ++row) {
    const auto [lo, hi] = t.columns(row);
    const std::int32_t first = std::max({lo, block.first.col, page.grid.first.col});
    const std::int32_t last = std::min({hi, block.last.col, page.grid.first.col + page.grid.cols - 1});
    const double start = half.plane.on_row(row);
    for (std::int32_t col = first; col <= last; ++col) {
      const std::size_t i = page.index(col - page.grid.first.col, row - page.grid.first.row);
      if (!page.valid.empty() && !page.valid[i]) continue;
      half.largest =
          std::max(half.largest, std::abs(page.height(i) - (start + half.plane.right * (col - half.plane.col))));
    }
  }
}

/// Measures the halves that touch a tile, page by page, so that each page is read back at most once.
void CoarseLevels::look_in(TileId id, const TileSummary& summary, const ReadBack& read_back) {
  std::vector<Large*> here;
  for_each_large_touching(id, [&](Large& half) { here.push_back(&half); });
  constexpr std::int32_t kPagesAcross = kTileSide / kPageSide, kBlocksAcross = kPageSide / kBlockSide;
  for (std::int32_t y = 0; y < kPagesAcross; ++y) {
    for (std::int32_t x = 0; x < kPagesAcross; ++x) {
      const Page* page = nullptr;
      for (std::int32_t b = 0; b < kBlocksAcross * kBlocksAcross; ++b) {
        const std::int32_t i =
            (y * kBlocksAcross + b / kBlocksAcross) * kTileBlocks + x * kBlocksAcross + b % kBlocksAcross;
        const TileRecord::Block& record = summary.record.blocks[static_cast<std::size_t>(i)];
        if (!record.has_data) continue;
        const GridRect square = square_of_block(id, i);
        for (Large* half : here) {
          if (!may_touch(half->t, square) || bound_of(record, square, half->plane) <= half->largest) continue;
          if (page == nullptr) {
            page = read_back({0, id.x * kPagesAcross + x, id.y * kPagesAcross + y});
            ++pages_read_back_;
            if (page == nullptr) break;
          }
          look(*half, *page, square);
        }
      }
    }
  }
}

void CoarseLevels::measure_large(const ForEachTile& tiles, const ReadBack& read_back) {
  collect_large();
  if (large_.empty()) return;
  tiles([&](TileId id, const TileSummary& summary) { bound_in(id, summary); });
  if (!read_back) {
    for (Large& half : large_) half.largest = std::max(half.largest, half.best_bound);
  }
  for (Large& half : large_) {  // first the block with the highest bound: then few others can exceed it
    if (half.best_bound <= half.largest) continue;
    const GridRect square = square_of_block(half.best_tile, half.best_block);
    ++pages_read_back_;
    if (const Page* page = read_back(page_of(square.first, 0))) look(half, *page, square);
  }
  tiles([&](TileId id, const TileSummary& summary) { look_in(id, summary, read_back); });
  for (const Large& half : large_) {
    const GridPoint unit{half.t.vertex.col >> kBlockShift, half.t.vertex.row >> kBlockShift};
    const int side = diamond(half.t.vertex).apexes[0] == half.t.apex ? 0 : 1;
    const bool exact = half.bits.interpolates_exactly(2 * half.t.s);
    const double metres = distance_.metres(half.largest) + (exact ? 0 : kRoundingMargin);
    ErrorCode code = error_code(metres * rule_.share(half.t, half.plane, distance_));
    if (this->half(unit, side) == kMixed) code = std::max(code, error_code(void_weight_ * ground_side_(half.t)));
    errors_[unit] = std::max(errors_[unit], code);
  }
}

// ---- saturation ------------------------------------------------------------------------------------

/// The largest error of a vertex's children; outside the rim every error is zero.
ErrorCode CoarseLevels::below(int shift, bool centres, GridPoint unit) const {
  ErrorCode largest = 0;
  if (shift == 0 && !centres) {
    for (const std::int32_t y : {unit.row - 1, unit.row}) {
      for (const std::int32_t x : {unit.col - 1, unit.col}) {
        if (has_block(x, y)) largest = std::max(largest, block_errors_[block(x, y)]);
      }
    }
    return largest;
  }
  const Children below = children(unit);
  for (int i = 0; i < below.count; ++i) {
    const GridPoint child = below.at[static_cast<std::size_t>(i)];
    if (errors_.holds(child)) largest = std::max(largest, errors_[child]);
  }
  return largest;
}

/// See saturate() in engine/error/saturation: a rounding margin must not hide that interpolation is exact.
bool CoarseLevels::is_exactly_zero(GridPoint unit) const {
  const Diamond d = diamond(unit);
  if (!units_.contains(unit) || !units_.contains(d.ends[0]) || !units_.contains(d.ends[1])) return false;
  if (half(unit, 0) == kMixed || half(unit, 1) == kMixed) return false;
  return halves_exactly(height(in_samples(d.ends[0])), height(in_samples(d.ends[1])), height(in_samples(unit)));
}

void CoarseLevels::saturate() {
  for (int shift = 0; shift < errors_.levels(); ++shift) {
    for (const bool centres : {false, true}) {
      errors_.for_each(shift, centres, [&](GridPoint unit) {
        ErrorCode& own = errors_[unit];
        const ErrorCode from_below = below(shift, centres, unit);
        if (own != 0 && from_below == 0 && is_exactly_zero(unit)) own = 0;
        own = std::max(own, from_below);
      });
    }
  }
}

}  // namespace talus
