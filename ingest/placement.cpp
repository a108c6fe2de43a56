#include "ingest/placement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "engine/grid.hpp"
#include "ingest/crs.hpp"
#include "ingest/warp.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr std::int64_t kMostSamples = std::int64_t{1} << 36;
constexpr double kOnTheGrid = 1e-3;  // cells between a sample and the grid's, over the whole raster

bool asks_for_resampling(const InputOptions& options) {
  return options.grid || !options.target_srs.empty() || options.target_dx != 0 || options.target_dy != 0 ||
         !options.resampling.empty();
}

std::string cells_of(const GridMapping& m) { return fmt::format("{} x {} at {}, {}", m.dx, -m.dy, m.x0, m.y0); }

/// Many files say the same of themselves: one comparison a text.
class Comparison {
 public:
  explicit Comparison(std::string reference) : reference_(std::move(reference)) {}
  bool operator()(const std::string& wkt) {
    if (wkt == reference_) return true;
    const auto [known, is_new] = known_.try_emplace(wkt, false);
    if (is_new) known->second = same_crs(wkt, reference_);
    return known->second;
  }

 private:
  std::string reference_;
  std::map<std::string, bool> known_;
};

struct Target {
  GridMapping mapping;
  std::string crs_wkt;   // heights included
  std::string flat_wkt;  // without
  std::string whose;     // the grid is, in failures
  double metres_per_unit;
  std::string vertical_unit;
};

GridMapping cells_for(const RasterFacts& first, const std::string& flat_wkt, bool is_same_crs,
                      const InputOptions& options) {
  const bool sized = options.target_dx != 0 || options.target_dy != 0;
  const auto is_size = [](double v) { return std::isfinite(v) && v > 0; };
  if (sized && !(is_size(options.target_dx) && is_size(options.target_dy))) {
    throw Failure(Cause::invalid_argument, fmt::format("--tr {} {}: expected a width and a height above 0",
                                                       options.target_dx, options.target_dy));
  }
  if (is_same_crs && !first.is_rotated) {
    const GridMapping& own = first.mapping;
    if (!sized || (own.dx == options.target_dx && own.dy == -options.target_dy)) return own;
  }
  GridMapping m = suggested_grid(first, flat_wkt);
  if (!sized) return m;
  // Cells that begin at multiples of their size, so that what is resampled alike fits together.
  const double west = m.x0 - 0.5 * m.dx, north = m.y0 - 0.5 * m.dy;
  m.dx = options.target_dx, m.dy = -options.target_dy;
  m.x0 = (std::floor(west / m.dx) + 0.5) * m.dx;
  m.y0 = (std::floor(north / m.dy) + 0.5) * m.dy;
  return m;
}

std::string flat(const std::string& wkt) { return wkt.empty() ? wkt : wkt_of(horizontal(crs_from(wkt)), "the target"); }

Target target_of(const std::vector<RasterFacts>& rasters, const InputOptions& options) {
  const RasterFacts& first = rasters.front();
  if (options.grid) {
    const Grid& g = *options.grid;
    return {g.mapping, g.crs_wkt, flat(g.crs_wkt), "the database", g.metres_per_unit, g.vertical_unit};
  }
  Target target{first.mapping, first.crs_wkt, "", first.name, first.metres_per_unit, first.vertical_unit};
  if (!asks_for_resampling(options)) return target;

  if (!options.target_srs.empty()) {
    const OGRSpatialReference asked = crs_from(wkt_of(options.target_srs, "--t-srs"));
    if (first.crs_wkt.empty()) {
      throw Failure(
          Cause::unsupported,
          fmt::format("{} states no coordinate system and cannot be taken to that of --t-srs; --srs gives one",
                      first.name));
    }
    const OGRSpatialReference own = crs_from(first.crs_wkt);
    if (has_heights(asked) ? !same_heights(asked, own) : has_heights(own) && own.IsCompound() == 0) {
      throw Failure(Cause::unsupported,
                    fmt::format("{} has heights of another kind than --t-srs {} states, and Talus changes no heights; "
                                "a --t-srs without heights keeps those of a vertical coordinate system",
                                first.name, options.target_srs));
    }
    target.crs_wkt = with_heights_of(asked, own);
  }
  target.flat_wkt = flat(target.crs_wkt);
  target.mapping = cells_for(first, target.flat_wkt, same_crs(target.crs_wkt, first.crs_wkt), options);
  if (!(target.mapping == first.mapping)) target.whose = "the target grid";
  return target;
}

/// Where the raster lies if its samples are the grid's own.
std::optional<GridRect> place_on(const GridMapping& grid, const RasterFacts& raster) {
  const GridMapping& m = raster.mapping;
  const double col = (m.x0 - grid.x0) / grid.dx, row = (m.y0 - grid.y0) / grid.dy;
  const double off = std::max(std::abs(col - std::nearbyint(col)), std::abs(row - std::nearbyint(row)));
  const double drift = std::max(std::abs(m.dx / grid.dx - 1) * raster.cols, std::abs(m.dy / grid.dy - 1) * raster.rows);
  if (!(off + drift <= kOnTheGrid)) return std::nullopt;
  constexpr double kFar = kMaxExtent;
  if (std::abs(col) > kFar || std::abs(row) > kFar) {
    throw Failure(
        Cause::invalid_argument,
        fmt::format("{} lies {} columns and {} rows away from the first sample of its grid; at most {} a side "
                    "can be taken in",
                    raster.name, std::nearbyint(col), std::nearbyint(row), kMaxExtent));
  }
  const GridPoint at{static_cast<std::int32_t>(std::nearbyint(col)), static_cast<std::int32_t>(std::nearbyint(row))};
  return GridRect{at, {at.col + raster.cols - 1, at.row + raster.rows - 1}};
}

void require_same_unit(const RasterFacts& raster, const Target& target) {
  if (raster.metres_per_unit == target.metres_per_unit) return;
  throw Failure(Cause::unsupported,
                fmt::format("{} has heights in {}, {} in {}; bring them to one unit first, or say with --vertical-unit "
                            "what all of them are in",
                            raster.name, raster.vertical_unit, target.whose, target.vertical_unit));
}

/// All heights count from the same; nothing changes them.
void require_same_heights(const RasterFacts& raster, const Target& target) {
  const OGRSpatialReference own = crs_from(raster.crs_wkt), wanted = crs_from(target.crs_wkt);
  if (raster.crs_wkt.empty() || target.crs_wkt.empty() || same_heights(own, wanted)) return;
  throw Failure(Cause::unsupported,
                fmt::format("{} states other heights in its coordinate system than {}, and Talus changes no heights; "
                            "--srs overrules what files state",
                            raster.name, target.whose));
}

[[noreturn]] void refuse_grid(const RasterFacts& raster, const Target& target, bool is_same_crs) {
  constexpr const char* kWays =
      "--t-srs, --tr and --resampling put all inputs on one grid, --grid-of on that of a database";
  if (!raster.is_placed || raster.crs_wkt.empty() != target.crs_wkt.empty()) {
    const bool is_target = raster.is_placed && !raster.crs_wkt.empty();
    throw Failure(
        Cause::unsupported,
        fmt::format("{} states no {}, {} does; {}", is_target ? target.whose : raster.name,
                    raster.is_placed ? "coordinate system" : "position", is_target ? raster.name : target.whose,
                    raster.is_placed ? "--srs gives one" : "it cannot be joined with others"));
  }
  if (!is_same_crs) {
    throw Failure(Cause::unsupported,
                  fmt::format("{} is in another coordinate system than {}; {}", raster.name, target.whose, kWays));
  }
  throw Failure(Cause::unsupported,
                fmt::format("{} has cells of {}, {} of {}: not one grid; {}", raster.name, cells_of(raster.mapping),
                            target.whose, cells_of(target.mapping), kWays));
}

// ---- the antimeridian ------------------------------------------------------------------------------

struct Lying {
  RasterFacts* raster;  // null: the database's extent
  std::int64_t first, last;
  std::int64_t turns = 0;  // to the east
};

/// Columns of a full turn, if they are a whole number.
std::int64_t columns_of_a_turn(const Target& target) {
  const double columns = full_turn(target.crs_wkt) / target.mapping.dx;
  const bool is_whole = columns >= 1 && std::abs(columns - std::nearbyint(columns)) <= kOnTheGrid;
  return is_whole && columns < kMaxExtent ? std::llround(columns) : 0;
}

/// Rasters on both sides of the antimeridian are neighbours: laid on a circle that is cut at its widest gap. Only
/// if they then touch and span less than half a turn; the first (or the database) stays where it is.
void join_across_antimeridian(std::vector<RasterFacts>& rasters, const Target& target, const InputOptions& options,
                              std::vector<std::string>& notes) {
  const std::int64_t turn = columns_of_a_turn(target);
  if (turn == 0) return;
  std::vector<Lying> all;
  if (options.grid && options.grid->extent.cols() > 0) {
    all.push_back({nullptr, options.grid->extent.first.col, options.grid->extent.last.col});
  }
  for (RasterFacts& raster : rasters) all.push_back({&raster, raster.place.first.col, raster.place.last.col});
  const RasterFacts* anchor = all.front().raster;
  if (all.size() < 2) return;
  const auto on_circle = [&](const Lying& l) { return ((l.first % turn) + turn) % turn; };
  std::sort(all.begin(), all.end(), [&](const Lying& a, const Lying& b) { return on_circle(a) < on_circle(b); });

  // The widest gap lies before the raster that the line begins with.
  std::size_t begin = 0;
  std::int64_t widest = -1, reached = -turn;
  for (const Lying& l : all) reached = std::max(reached, on_circle(l) + l.last - l.first - turn);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (const std::int64_t gap = on_circle(all[i]) - reached; gap > widest) widest = gap, begin = i;
    reached = std::max(reached, on_circle(all[i]) + all[i].last - all[i].first);
  }
  if (widest <= 1) return;  // they go all the way round
  std::rotate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(begin), all.end());
  std::int64_t lap = 0, before = -1, anchor_turns = 0;
  for (Lying& l : all) {
    if (on_circle(l) < before) lap = 1;
    before = on_circle(l);
    l.turns = (before + lap * turn - l.first) / turn;
    if (l.raster == anchor) anchor_turns = l.turns;
  }
  std::int64_t end = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Lying& l = all[i];
    const std::int64_t from = l.first + l.turns * turn, to = l.last + l.turns * turn;
    if (i > 0 && l.turns != all[i - 1].turns && from > end + 1) return;  // they do not touch
    end = i == 0 ? to : std::max(end, to);
  }
  if (end - (all.front().first + all.front().turns * turn) >= turn / 2) return;
  std::size_t moved = 0;
  for (Lying& l : all) {
    l.turns -= anchor_turns;
    if (l.turns != 0 &&
        (std::abs(l.first + l.turns * turn) > kMaxExtent || std::abs(l.last + l.turns * turn) > kMaxExtent))
      return;
  }
  const std::string* name = nullptr;
  for (const Lying& l : all) {
    if (l.turns == 0 || l.raster == nullptr) continue;
    l.raster->place.first.col = static_cast<std::int32_t>(l.first + l.turns * turn);
    l.raster->place.last.col = static_cast<std::int32_t>(l.last + l.turns * turn);
    if (++moved == 1) name = &l.raster->name;
  }
  if (moved == 0) return;
  notes.push_back(fmt::format("{}{}: placed a full turn further, to join its neighbours across the antimeridian", *name,
                              moved == 1 ? "" : fmt::format(" and {} more", moved - 1)));
}

}  // namespace

Placement place_on_one_grid(std::vector<RasterFacts>& rasters, const InputOptions& options) {
  const GDALResampleAlg method = resampling_of(options.resampling);
  const bool may_resample = asks_for_resampling(options);
  if (!may_resample) require_own_grid(rasters.front());
  Placement placement;
  Target target = target_of(rasters, options);
  if (!options.grid && !(target.mapping == rasters.front().mapping)) {
    // A grid made for the occasion begins with the first input's first sample.
    const GridPoint first = plan_warp(rasters.front(), target.flat_wkt, target.mapping, method).place.first;
    target.mapping.x0 = target.mapping.x(first.col);
    target.mapping.y0 = target.mapping.y(first.row);
  }
  Comparison is_same(target.crs_wkt), is_same_flat(target.flat_wkt);
  std::map<std::string, bool> heights_checked;
  for (RasterFacts& raster : rasters) {
    require_same_unit(raster, target);
    const bool is_same_crs = is_same(raster.crs_wkt);
    if (!is_same_crs && heights_checked.try_emplace(raster.crs_wkt, true).second) require_same_heights(raster, target);
    if (!raster.is_rotated && is_same_crs && (raster.is_placed || rasters.size() == 1)) {
      if (const std::optional<GridRect> place = place_on(target.mapping, raster)) {
        raster.place = *place;
        continue;
      }
    }
    if (!may_resample && raster.is_rotated) require_own_grid(raster);
    if (!may_resample || !raster.is_placed || raster.crs_wkt.empty() != target.crs_wkt.empty()) {
      refuse_grid(raster, target, is_same_crs);
    }
    raster.warp = plan_warp(raster, target.flat_wkt, target.mapping, method);
    raster.place = raster.warp->place;
    raster.notes.push_back("is resampled: what is promised of its heights is promised of the resampled ones");
  }
  join_across_antimeridian(rasters, target, options, placement.notes);

  std::int64_t west = kMaxExtent, north = kMaxExtent, east = -kMaxExtent, south = -kMaxExtent;
  for (const RasterFacts& raster : rasters) {
    west = std::min<std::int64_t>(west, raster.place.first.col);
    north = std::min<std::int64_t>(north, raster.place.first.row);
    east = std::max<std::int64_t>(east, raster.place.last.col);
    south = std::max<std::int64_t>(south, raster.place.last.row);
  }
  const std::int64_t cols = east - west + 1, rows = south - north + 1;
  if (west < -kMaxExtent || north < -kMaxExtent || east > kMaxExtent || south > kMaxExtent || cols > kMaxExtent ||
      rows > kMaxExtent || cols > kMostSamples / rows) {
    throw Failure(
        Cause::invalid_argument,
        fmt::format("{}{} {} x {} samples; at most {} a side and {} in all can be taken in", rasters.front().name,
                    rasters.size() == 1 ? " is" : fmt::format(" and {} more span", rasters.size() - 1), cols, rows,
                    kMaxExtent, kMostSamples));
  }
  placement.mapping = target.mapping;
  placement.extent = {{static_cast<std::int32_t>(west), static_cast<std::int32_t>(north)},
                      {static_cast<std::int32_t>(east), static_cast<std::int32_t>(south)}};
  placement.crs_wkt = target.crs_wkt;
  require_distinct(placement.mapping, placement.extent, target.whose);
  return placement;
}

}  // namespace talus
