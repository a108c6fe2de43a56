#include "ingest/mosaic/common_grid.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/grid.hpp"
#include "ingest/raster/crs.hpp"

namespace talus {

std::optional<GridRect> place_on(const GridMapping& grid, const RasterFacts& raster) {
  const GridMapping& m = raster.mapping;
  const double col = (m.x0 - grid.x0) / grid.dx, row = (m.y0 - grid.y0) / grid.dy;
  const double off = std::max(std::abs(col - std::nearbyint(col)), std::abs(row - std::nearbyint(row)));
  const double drift = std::max(std::abs(m.dx / grid.dx - 1) * raster.cols, std::abs(m.dy / grid.dy - 1) * raster.rows);
  if (!(off + drift <= kOnTheGrid)) return std::nullopt;
  constexpr double kFar = kMaxExtent;
  if (std::abs(col) > kFar || std::abs(row) > kFar) {
    fail_in(
        raster.name, Cause::invalid_argument,
        "{} lies {} columns and {} rows away from the first sample of its grid, but a database has at most {} a side",
        raster.name, std::nearbyint(col), std::nearbyint(row), kMaxExtent);
  }
  const GridPoint at{static_cast<std::int32_t>(std::nearbyint(col)), static_cast<std::int32_t>(std::nearbyint(row))};
  return GridRect{at, {at.col + raster.cols - 1, at.row + raster.rows - 1}};
}

std::int64_t columns_of_a_turn(const std::string& crs_wkt, const GridMapping& grid) {
  const double columns = full_turn(crs_wkt) / grid.dx;
  const bool is_whole = columns >= 1 && std::abs(columns - std::nearbyint(columns)) <= kOnTheGrid;
  return is_whole && columns < kMaxExtent ? std::llround(columns) : 0;
}

namespace {

struct Lying {
  std::size_t index;
  std::int64_t first, last;
  std::int64_t turns = 0;  // full turns to move east
};

}  // namespace

std::vector<std::size_t> join_across_antimeridian(const std::vector<GridRect*>& places, std::int64_t turn) {
  if (turn == 0 || places.size() < 2) return {};
  std::vector<Lying> all;
  for (std::size_t i = 0; i < places.size(); ++i) all.push_back({i, places[i]->first.col, places[i]->last.col});
  const auto on_circle = [&](const Lying& l) { return ((l.first % turn) + turn) % turn; };
  std::sort(all.begin(), all.end(), [&](const Lying& a, const Lying& b) { return on_circle(a) < on_circle(b); });

  // The widest gap lies west of the raster at `begin`.
  std::size_t begin = 0;
  std::int64_t widest = -1, reached = -turn;
  for (const Lying& l : all) reached = std::max(reached, on_circle(l) + l.last - l.first - turn);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (const std::int64_t gap = on_circle(all[i]) - reached; gap > widest) widest = gap, begin = i;
    reached = std::max(reached, on_circle(all[i]) + all[i].last - all[i].first);
  }
  if (widest <= 1) return {};  // they go around the globe
  std::rotate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(begin), all.end());
  std::int64_t lap = 0, before = -1, anchor_turns = 0;
  for (Lying& l : all) {
    if (on_circle(l) < before) lap = 1;
    before = on_circle(l);
    l.turns = (before + lap * turn - l.first) / turn;
    if (l.index == 0) anchor_turns = l.turns;
  }
  std::int64_t end = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Lying& l = all[i];
    const std::int64_t from = l.first + l.turns * turn, to = l.last + l.turns * turn;
    if (i > 0 && l.turns != all[i - 1].turns && from > end + 1) return {};  // neighbours do not touch
    end = i == 0 ? to : std::max(end, to);
  }
  if (end - (all.front().first + all.front().turns * turn) >= turn / 2) return {};
  for (Lying& l : all) {
    l.turns -= anchor_turns;
    if (l.turns != 0 &&
        (std::abs(l.first + l.turns * turn) > kMaxExtent || std::abs(l.last + l.turns * turn) > kMaxExtent))
      return {};
  }
  std::vector<std::size_t> moved;
  for (const Lying& l : all) {
    if (l.turns == 0) continue;
    places[l.index]->first.col = static_cast<std::int32_t>(l.first + l.turns * turn);
    places[l.index]->last.col = static_cast<std::int32_t>(l.last + l.turns * turn);
    moved.push_back(l.index);
  }
  std::sort(moved.begin(), moved.end());
  return moved;
}

std::string name_of_all(const std::string& first, std::size_t count) {
  return count == 1 ? first : fmt::format("{} and {} more", first, count - 1);
}

std::string note_of_turn(const std::string& name, std::size_t moved) {
  return fmt::format("{}: moved by a full turn of longitude, to join {} neighbours across the antimeridian",
                     name_of_all(name, moved), moved == 1 ? "its" : "their");
}

}  // namespace talus
