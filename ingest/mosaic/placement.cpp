#include "ingest/mosaic/placement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/grid.hpp"
#include "engine/quadtree/rect.hpp"
#include "ingest/mosaic/common_grid.hpp"
#include "ingest/mosaic/laid_rasters.hpp"
#include "ingest/mosaic/warp.hpp"
#include "ingest/raster/crs.hpp"

namespace talus {
namespace {

constexpr std::int64_t kMostSamples = std::int64_t{1} << 36;

bool asks_for_resampling(const InputOptions& options) {
  return options.grid || !options.target_srs.empty() || options.target_dx != 0 || options.target_dy != 0 ||
         options.resampling.has_value();
}

std::string cells_of(const GridMapping& m) { return fmt::format("{} x {} at {}, {}", m.dx, -m.dy, m.x0, m.y0); }

/// Compares with one text. Many files have equal texts, so each is compared once.
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
  std::string flat_wkt;  // without heights
  std::string whose;     // the grid's owner, for failures
  double metres_per_unit;
  std::string vertical_unit;
};

GridMapping cells_for(const RasterFacts& first, const LaidRasters& laid, const std::string& flat_wkt, bool is_same_crs,
                      const InputOptions& options) {
  const bool sized = options.target_dx != 0 || options.target_dy != 0;
  const auto is_size = [](double v) { return std::isfinite(v) && v > 0; };
  if (sized && !(is_size(options.target_dx) && is_size(options.target_dy))) {
    refuse("InputOptions::target_dx {} {}: expected a width and a height above 0", options.target_dx,
           options.target_dy);
  }
  if (is_same_crs && !first.is_rotated) {
    const GridMapping& own = first.mapping;
    if (!sized || (own.dx == options.target_dx && own.dy == -options.target_dy)) return own;
  }
  GridMapping m = suggested_grid(laid, flat_wkt);
  if (!sized) return m;
  // Cells begin at multiples of their size, so that rasters resampled alike fit together.
  const double west = m.x0 - 0.5 * m.dx, north = m.y0 - 0.5 * m.dy;
  m.dx = options.target_dx, m.dy = -options.target_dy;
  m.x0 = (std::floor(west / m.dx) + 0.5) * m.dx;
  m.y0 = (std::floor(north / m.dy) + 0.5) * m.dy;
  return m;
}

std::string flat(const std::string& wkt) { return wkt.empty() ? wkt : wkt_of(horizontal(crs_from(wkt)), "the target"); }

/// laid  the sets of rasters that can be resampled together, the first input's first; empty if none may be
Target target_of(const std::vector<RasterFacts>& rasters, const std::vector<LaidRasters>& laid,
                 const InputOptions& options) {
  const RasterFacts& first = rasters.front();
  if (options.grid) {
    const Grid& g = *options.grid;
    return {g.mapping, g.crs_wkt, flat(g.crs_wkt), "the database", g.metres_per_unit, g.vertical_unit};
  }
  Target target{first.mapping, first.crs_wkt, "", first.name, first.metres_per_unit, first.vertical_unit};
  if (!asks_for_resampling(options)) return target;

  if (!options.target_srs.empty()) {
    const OGRSpatialReference asked = crs_from(wkt_of(options.target_srs, "InputOptions::target_srs"));
    if (first.crs_wkt.empty()) {
      fail(Cause::unsupported,
           "{} states no coordinate system, so it cannot be transformed to InputOptions::target_srs. Name its own with "
           "InputOptions::srs",
           first.name);
    }
    const OGRSpatialReference own = crs_from(first.crs_wkt);
    if (has_heights(asked) ? !same_heights(asked, own) : has_heights(own) && own.IsCompound() == 0) {
      fail(Cause::unsupported,
           "{} has heights of another kind than InputOptions::target_srs {}, and Talus does not convert heights. "
           "Without a vertical part, InputOptions::target_srs keeps the vertical coordinate system of the input",
           first.name, options.target_srs);
    }
    target.crs_wkt = with_heights_of(asked, own);
  }
  target.flat_wkt = flat(target.crs_wkt);
  target.mapping = cells_for(first, laid.front(), target.flat_wkt, same_crs(target.crs_wkt, first.crs_wkt), options);
  if (!(target.mapping == first.mapping)) target.whose = "the target grid";
  return target;
}

void require_same_unit(const RasterFacts& raster, const Target& target) {
  if (raster.metres_per_unit == target.metres_per_unit) return;
  fail(Cause::unsupported,
       "{} has heights in {}, {} in {}. Convert them to one unit first, or name the unit of all with "
       "InputOptions::vertical_unit",
       raster.name, raster.vertical_unit, target.whose, target.vertical_unit);
}

/// Refuses heights of another kind than the target's.
void require_same_heights(const RasterFacts& raster, const Target& target) {
  const OGRSpatialReference own = crs_from(raster.crs_wkt), wanted = crs_from(target.crs_wkt);
  if (raster.crs_wkt.empty() || target.crs_wkt.empty() || same_heights(own, wanted)) return;
  fail(Cause::unsupported,
       "{} states other heights in its coordinate system than {}, and Talus does not convert heights. If a file is "
       "wrong, name the right coordinate system with InputOptions::srs",
       raster.name, target.whose);
}

[[noreturn]] void refuse_grid(const RasterFacts& raster, const Target& target, bool is_same_crs) {
  constexpr const char* kWays =
      "Put all inputs on one grid with InputOptions::target_srs, InputOptions::target_dx or InputOptions::resampling, "
      "or on that of a database with InputOptions::grid";
  if (raster.crs_wkt.empty() != target.crs_wkt.empty()) {
    const bool is_target = !raster.crs_wkt.empty();
    fail_in(raster.name, Cause::unsupported,
            "{} states no coordinate system, but {} does. Name it with InputOptions::srs",
            is_target ? target.whose : raster.name, is_target ? raster.name : target.whose);
  }
  if (!is_same_crs) {
    fail_in(raster.name, Cause::unsupported,
            "{} is in another coordinate system than {}. {}. If a file states a wrong one, name the right one of all "
            "inputs with InputOptions::srs",
            raster.name, target.whose, kWays);
  }
  fail_in(raster.name, Cause::unsupported, "{} has cells of {}, but {} has cells of {}. {}", raster.name,
          cells_of(raster.mapping), target.whose, cells_of(target.mapping), kWays);
}

/// Several rasters need positions; a raster with a CRS needs one, too.
void require_positions(const std::vector<RasterFacts>& rasters) {
  for (const RasterFacts& raster : rasters) {
    if (raster.is_placed) continue;
    if (!raster.other_position.empty()) {
      fail_in(raster.name, Cause::unsupported,
              "{} states its position by {}, not by a grid. Resample it to a grid with gdalwarp first", raster.name,
              raster.other_position);
    }
    if (rasters.size() > 1) {
      const auto bare =
          std::count_if(rasters.begin(), rasters.end(), [](const RasterFacts& r) { return !r.is_placed; });
      fail_in(raster.name, Cause::unsupported,
              "{}{} no position, so it cannot be joined with others. Add a position, for instance with gdal_translate "
              "-a_ullr or a world file",
              raster.name, bare == 1 ? " states" : fmt::format(" and {} more state", bare - 1));
    }
    if (!raster.crs_wkt.empty()) {
      fail_in(raster.name, Cause::unsupported,
              "{} has a coordinate system but states no position in it. Add one, for instance with gdal_translate "
              "-a_ullr or a world file",
              raster.name);
    }
  }
}

/// The samples of the target that a member can change. GDAL's places of a part and of the whole differ by a cell or so
/// at the edges; the exact owner of a sample is found later.
GridRect place_of_member(const LaidRasters& laid, GridRect member) {
  if (laid.members.size() == 1) return laid.place;
  constexpr std::int32_t kAround = 2;
  return common(grown(place_of(laid, member), kAround), laid.place);
}

/// Plans the resampling of the sets that contain one of `rasters`.
void resample(const std::vector<RasterFacts*>& rasters, std::vector<LaidRasters>& laid, const Target& target,
              GDALResampleAlg method) {
  for (LaidRasters& set : laid) {
    const auto member_of = [&](const RasterFacts& raster) {
      return std::find_if(set.members.begin(), set.members.end(),
                          [&](const RasterFacts& m) { return m.file == raster.file; });
    };
    std::vector<RasterFacts*> ours;
    for (RasterFacts* raster : rasters) {
      if (member_of(*raster) != set.members.end()) ours.push_back(raster);
    }
    if (ours.empty()) continue;
    plan_warp(set, target.flat_wkt, target.mapping, method);
    const auto shared = std::make_shared<const LaidRasters>(std::move(set));
    set = LaidRasters{};
    for (RasterFacts* raster : ours) {
      const auto member = std::find_if(shared->members.begin(), shared->members.end(),
                                       [&](const RasterFacts& m) { return m.file == raster->file; });
      Warp warp{shared, static_cast<int>(member - shared->members.begin()), shared->type_of_result,
                place_of_member(*shared, member->place)};
      raster->place = warp.place;
      raster->scale = shared->scale;
      raster->offset = shared->offset;
      raster->warp = std::move(warp);
    }
  }
}

/// Longitudes a full turn apart are the same place. Joins neighbours across the antimeridian. If the rasters go around
/// the globe, the grid is one turn wide, and what lies beyond its end is moved to its beginning.
void lay_on_circle(std::vector<RasterFacts>& rasters, const Target& target, const InputOptions& options,
                   Placement& placement) {
  const std::int64_t turn = columns_of_a_turn(target.crs_wkt, target.mapping);
  if (turn == 0) return;
  const bool has_base = options.grid && options.grid->extent.cols() > 0;
  GridRect base = has_base ? options.grid->extent : GridRect{};
  std::vector<GridRect*> places;
  if (has_base) places.push_back(&base);
  for (RasterFacts& raster : rasters) places.push_back(&raster.place);
  const std::vector<std::size_t> moved = join_across_antimeridian(places, turn);
  if (!moved.empty()) {
    placement.notes.push_back(note_of_turn(rasters[moved.front() - (has_base ? 1 : 0)].name, moved.size()));
  }

  const GridRect& anchor = *places.front();
  std::int64_t west = anchor.first.col, east = anchor.last.col;
  for (const GridRect* place : places) {
    west = std::min<std::int64_t>(west, place->first.col);
    east = std::max<std::int64_t>(east, place->last.col);
  }
  const std::int64_t width = std::max(turn, anchor.cols());
  if (east - west + 1 <= std::max(turn + 1, anchor.cols())) return;  // a raster may repeat its first column at its end
  placement.columns = {{anchor.first.col, static_cast<std::int32_t>(anchor.first.col + width - 1)}};
  for (RasterFacts& raster : rasters) {
    const std::int64_t first = raster.place.first.col, last = raster.place.last.col;
    // All turns at which the raster meets the grid.
    std::vector<std::int64_t> turns;
    for (std::int64_t t = -((last - placement.columns->first) / turn) - 1; first + t * turn <= placement.columns->last;
         ++t) {
      if (last + t * turn >= placement.columns->first) turns.push_back(t * turn);
    }
    raster.place.first.col = static_cast<std::int32_t>(first + turns.front());
    raster.place.last.col = static_cast<std::int32_t>(last + turns.front());
    for (std::size_t i = 1; i < turns.size(); ++i)
      raster.also_east.push_back(static_cast<std::int32_t>(turns[i] - turns.front()));
  }
  placement.notes.push_back("longitudes go around the globe: samples a full turn away were moved to their place");
}

/// The rectangle that all inputs span.
GridRect extent_of(const std::vector<RasterFacts>& rasters, const Placement& placement) {
  std::int64_t west = kMaxExtent, north = kMaxExtent, east = -kMaxExtent, south = -kMaxExtent;
  for (const RasterFacts& raster : rasters) {
    west = std::min<std::int64_t>(west, raster.place.first.col);
    north = std::min<std::int64_t>(north, raster.place.first.row);
    east =
        std::max<std::int64_t>(east, raster.place.last.col + (raster.also_east.empty() ? 0 : raster.also_east.back()));
    south = std::max<std::int64_t>(south, raster.place.last.row);
  }
  if (placement.columns) {
    west = std::max<std::int64_t>(west, placement.columns->first);
    east = std::min<std::int64_t>(east, placement.columns->last);
  }
  const std::int64_t cols = east - west + 1, rows = south - north + 1;
  if (west < -kMaxExtent || north < -kMaxExtent || east > kMaxExtent || south > kMaxExtent || cols > kMaxExtent ||
      rows > kMaxExtent || cols > kMostSamples / rows) {
    refuse("{} {} {} x {} samples, but a database has at most {} a side and {} in all",
           name_of_all(rasters.front().name, rasters.size()), rasters.size() == 1 ? "has" : "have", cols, rows,
           kMaxExtent, kMostSamples);
  }
  return {{static_cast<std::int32_t>(west), static_cast<std::int32_t>(north)},
          {static_cast<std::int32_t>(east), static_cast<std::int32_t>(south)}};
}

}  // namespace

Placement place_on_one_grid(std::vector<RasterFacts>& rasters, const InputOptions& options) {
  const GDALResampleAlg method = algorithm_of(options.resampling.value_or(Resampling::bilinear));
  const bool may_resample = asks_for_resampling(options);
  require_positions(rasters);
  if (!may_resample) require_own_grid(rasters.front());
  Placement placement;
  std::vector<LaidRasters> laid;
  if (may_resample) laid = laid_together(rasters, placement.notes);
  Target target = target_of(rasters, laid, options);
  if (!options.grid && !(target.mapping == rasters.front().mapping)) {
    // A new grid begins at the first sample of the first input and of the inputs laid together with it.
    plan_warp(laid.front(), target.flat_wkt, target.mapping, method);
    const GridPoint first = laid.front().place.first;
    target.mapping.x0 = target.mapping.x(first.col);
    target.mapping.y0 = target.mapping.y(first.row);
  }
  Comparison is_same(target.crs_wkt), is_same_flat(target.flat_wkt);
  std::map<std::string, bool> heights_checked;
  std::vector<RasterFacts*> to_resample;
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
    to_resample.push_back(&raster);
    raster.notes.push_back("is resampled: every bound refers to the resampled heights");
  }
  resample(to_resample, laid, target, method);
  lay_on_circle(rasters, target, options, placement);
  placement.mapping = target.mapping;
  placement.extent = extent_of(rasters, placement);
  placement.crs_wkt = target.crs_wkt;
  require_distinct(placement.mapping, placement.extent, target.whose);
  return placement;
}

}  // namespace talus
