#include "ingest/job/changes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "ingest/mosaic/common_grid.hpp"

namespace talus {
namespace {

GridRect with(GridRect rect, GridPoint p) { return is_empty(rect) ? GridRect{p, p} : around(rect, {p, p}); }

TileId tile_of(GridPoint p) { return {p.col >> kTileShift, p.row >> kTileShift}; }
std::uint64_t place_of(TileId id) { return curve_position({1, id.x, id.y}); }

/// Records one changed sample.
void note(Changes& changes, const Description& d, GridPoint p, bool was_void, double height_difference) {
  UpdateChange& sum = changes.sum;
  const bool is_first_height = sum.samples == sum.filled;
  ++sum.samples;
  sum.region = with(sum.region, p);
  const auto [tile, is_new] = changes.of_tiles.try_emplace(place_of(tile_of(p)), GridRect{p, p});
  if (!is_new) tile->second = with(tile->second, p);
  if (was_void) {
    ++sum.filled;
    return;
  }
  const double metres = std::abs(height_difference) * d.metres_per_unit;
  const bool is_earlier =
      p.row < changes.largest_at.row || (p.row == changes.largest_at.row && p.col < changes.largest_at.col);
  if (!is_first_height && (metres < sum.largest.value || (metres == sum.largest.value && !is_earlier))) return;
  sum.largest = Metres{metres};
  changes.largest_at = p;
  sum.x = d.mapping.x(p.col);
  sum.y = d.mapping.y(p.row);
}

void compare(Changes& changes, const Description& d, const Window& fresh, const Window& old) {
  const CodeSpan now = view(fresh.codes), then = view(old.codes);
  for_each_point(fresh.region, [&](GridPoint p) {
    const std::size_t i = index_in(fresh.region, p);
    if (!fresh.valid.empty() && fresh.valid[i] == 0) return;
    const bool was_void = old.valid[i] == 0;
    const double after = code_at(now, i), before = code_at(then, i);
    // Compare bits: -0.0 is stored as -0.0.
    if (!was_void && std::bit_cast<std::uint64_t>(after) == std::bit_cast<std::uint64_t>(before)) return;
    note(changes, d, p, was_void, d.step.value(after) - d.step.value(before));
  });
}

}  // namespace

Codes codes_of_kind(std::size_t kind, std::size_t samples) {
  if (kind == 0) return std::vector<std::int16_t>(samples);
  if (kind == 1) return std::vector<float>(samples);
  return std::vector<double>(samples);
}

bool Changes::touches(GridRect window) const {
  if (is_empty(window)) return false;
  const TileId first = tile_of(window.first), last = tile_of(window.last);
  for (std::int32_t y = first.y; y <= last.y; ++y) {
    for (std::int32_t x = first.x; x <= last.x; ++x) {
      const auto found = of_tiles.find(place_of({x, y}));
      if (found != of_tiles.end() && overlap(found->second, window)) return true;
    }
  }
  return false;
}

Changes changes_by(const ExistingDatabase& base, const Source& source, std::size_t kind, std::int32_t tiles_across,
                   const std::function<void()>& tell) {
  Changes changes;
  const Description& d = base.manifest().description;
  const GridRect all = source.description().extent;
  const TileId first = tile_of(all.first), last = tile_of(all.last);
  Window fresh, old;
  for (std::int32_t y = first.y; y <= last.y; ++y) {
    for (std::int32_t x = first.x; x <= last.x; x += tiles_across) {
      const std::int32_t east = std::min(x + tiles_across - 1, last.x);
      const GridRect part =
          common(all, {{x * kTileSide, y * kTileSide}, {(east + 1) * kTileSide - 1, (y + 1) * kTileSide - 1}});
      tell();
      if (!source.touches(part)) continue;
      source.read_into(fresh, part, part);
      old.region = part;
      old.codes = codes_of_kind(kind, static_cast<std::size_t>(part.samples()));
      old.valid.assign(static_cast<std::size_t>(part.samples()), 0);
      base.fill(old);
      compare(changes, d, fresh, old);
    }
  }
  return changes;
}

}  // namespace talus
