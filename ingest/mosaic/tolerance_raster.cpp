#include "ingest/mosaic/tolerance_raster.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/geo/ground.hpp"
#include "engine/machine/fail.hpp"
#include "engine/quadtree/rect.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "ingest/raster/crs.hpp"
#include "ingest/raster/raster_facts.hpp"
#include "talus/ingest.hpp"

namespace talus {
namespace {

void require_one_band(const RasterFacts& facts) {
  GdalScope gdal;
  const int bands = GDALGetRasterCount(open_dataset(facts).get());
  if (bands != 1) refuse("{} has {} bands; expected one band, of tolerances in metres", facts.name, bands);
}

void require_same_places(const RasterFacts& facts, const Description& database) {
  if (facts.crs_wkt.empty()) return;
  const bool is_known = !database.crs_wkt.empty();
  GdalScope gdal;
  if (is_known && same_crs(wkt_of(horizontal(crs_from(facts.crs_wkt)), facts.name),
                           wkt_of(horizontal(crs_from(database.crs_wkt)), "the database")))
    return;
  refuse("{} is in another coordinate system than the database{}. Transform it with gdalwarp -t_srs first", facts.name,
         is_known ? "" : ", which states none");
}

/// Cells that divide a region evenly, where each sample stands for a whole cell of the grid.
GridMapping evenly_over(const Description& d, GridRect region, const RasterFacts& facts) {
  const double dx = static_cast<double>(region.cols()) * d.mapping.dx / facts.cols;
  const double dy = static_cast<double>(region.rows()) * d.mapping.dy / facts.rows;
  return {d.mapping.x(region.first.col - 0.5) + dx / 2, d.mapping.y(region.first.row - 0.5) + dy / 2, dx, dy};
}

/// The cells, moved by full turns of longitude to the region.
GridMapping on_turn_of(const Description& d, GridRect region, GridMapping cells, const RasterFacts& facts) {
  const double turn = Ground(d.crs).full_turn();
  if (turn == 0) return cells;
  const double ours = (d.mapping.x(region.first.col) + d.mapping.x(region.last.col)) / 2;
  const double theirs = cells.x0 + cells.dx * (facts.cols - 1) / 2;
  cells.x0 += std::round((ours - theirs) / turn) * turn;
  return cells;
}

/// The cells around a region's samples; last < first: none.
GridRect cells_over(const Description& d, GridRect region, const GridMapping& cells, const RasterFacts& facts) {
  const auto cell = [](double at, int count) {
    return static_cast<std::int32_t>(std::clamp<double>(std::floor(at + 0.5), -2, count + 1));
  };
  const auto col = [&](std::int32_t v) { return cell((d.mapping.x(v) - cells.x0) / cells.dx, facts.cols); };
  const auto row = [&](std::int32_t v) { return cell((d.mapping.y(v) - cells.y0) / cells.dy, facts.rows); };
  // One more cell on each side, because samples on lines between cells may be rounded either way.
  return {{std::max(col(region.first.col) - 1, 0), std::max(row(region.first.row) - 1, 0)},
          {std::min(col(region.last.col) + 1, facts.cols - 1), std::min(row(region.last.row) + 1, facts.rows - 1)}};
}

}  // namespace

ToleranceRaster read_tolerances(const std::filesystem::path& file, const Description& database, GridRect region) {
  const RasterFacts facts = look_at(file, {});
  require_one_band(facts);
  require_same_places(facts, database);
  require_own_grid(facts);
  ToleranceRaster raster;
  const bool is_placed = facts.is_placed || !facts.crs_wkt.empty();
  raster.cells = is_placed ? on_turn_of(database, region, facts.mapping, facts) : evenly_over(database, region, facts);
  const GridRect part = cells_over(database, region, raster.cells, facts);
  if (is_empty(part)) refuse("{} does not overlap the rectangle of the question", facts.name);
  raster.metres = Raster(std::vector{file}, InputOptions{}).read(part);
  for (double& metres : raster.metres.values) metres *= facts.metres_per_unit;
  return raster;
}

}  // namespace talus
