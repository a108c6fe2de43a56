#include "talus/database.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "engine/machine/parallel.hpp"
#include "engine/quadtree/triangulation.hpp"
#include "query/bounded/bounded_heights.hpp"
#include "engine/geo/longitude.hpp"
#include "query/selection/budget.hpp"
#include "query/selection/increment.hpp"
#include "query/selection/refusals.hpp"
#include "query/selection/selection.hpp"
#include "query/selection/vertex_errors.hpp"
#include "query/snapshot_view.hpp"
#include "query/surface/heights.hpp"
#include "query/surface/profile.hpp"

namespace talus {

namespace {

/// In cells from grid line 0. Beside a line, within 10⁻⁶ of a cell or as near as doubles tell places so far out apart,
/// it is on the line.
double line_at(double coordinate, double line_0, double cell) {
  constexpr double kOnLine = 1e-6, kApart = 4 * std::numeric_limits<double>::epsilon();
  const double at = (coordinate - line_0) / cell, line = std::round(at);
  const double rounding = kApart * std::max(std::abs(coordinate), std::abs(line_0)) / std::abs(cell);
  return std::abs(at - line) <= std::max(kOnLine, rounding) ? line : at;
}

}  // namespace

struct Database::Opened {
  PageStore store;
  std::shared_ptr<PageCache> cache;  ///< snapshots share it, and may outlive this
  int threads = 1;
};

Database::Database(std::shared_ptr<Opened> opened) : opened_(std::move(opened)) {}

Database Database::open(const std::filesystem::path& file, const OpenOptions& options) {
  return blaming(file, [&] {
    Database database(std::make_shared<Opened>(Opened{
        PageStore::open(file), std::make_shared<PageCache>(options.cache_bytes), threads_or_all(options.threads)}));
    (void)database.snapshot();  // a header that cannot be read is said here, not at the first question
    return database;
  });
}

Snapshot Database::snapshot() const {
  return Snapshot(
      std::make_unique<Snapshot::View>(Snapshot::View{StoredPages(opened_->store, opened_->cache), opened_->threads}));
}

Snapshot::Snapshot(std::unique_ptr<View> view) : view_(std::move(view)) {}
Snapshot::~Snapshot() = default;
Snapshot::Snapshot(Snapshot&&) noexcept = default;
Snapshot& Snapshot::operator=(Snapshot&&) noexcept = default;

const Description& Snapshot::description() const { return view_->pages.manifest().description; }

const StoredPages& pages_of(const Snapshot& snapshot) { return snapshot.view_->pages; }

StorageSummary Snapshot::storage() const {
  const Manifest& manifest = view_->pages.manifest();
  const ReadTxn& txn = view_->pages.transaction();
  StorageSummary summary;
  summary.format_version = kFormatVersion;
  summary.file_bytes = txn.file_bytes();
  for (int band = 0; band < manifest.bands; ++band) {
    const TableSummary table = txn.summary(band);
    summary.bands.push_back({band_spacing(band), table.pages, table.bytes});
    summary.pages += table.pages;
    summary.page_bytes += table.bytes;
  }
  return summary;
}

Provenance Snapshot::provenance() const {
  const auto stored = view_->pages.transaction().find({kHeaderTable, kProvenancePosition});
  return stored ? decode_provenance(stored->content) : Provenance{};
}

GridRect Snapshot::region(const Rectangle& asked) const {
  const Description& d = description();
  const auto text = fmt::format("{},{},{},{}", asked.xmin, asked.ymin, asked.xmax, asked.ymax);
  const Rectangle r = view_->pages.longitudes().among(asked);
  if (!(r.xmin < r.xmax) || !(r.ymin < r.ymax) || !std::isfinite(r.xmin) || !std::isfinite(r.ymin) ||
      !std::isfinite(r.xmax) || !std::isfinite(r.ymax)) {
    throw Failure(Cause::invalid_argument, fmt::format("rectangle {}: expected xmin < xmax and ymin < ymax", text));
  }
  // Outward to grid lines.
  const GridMapping& m = d.mapping;
  const double west = std::floor(line_at(r.xmin, m.x0, m.dx)), east = std::ceil(line_at(r.xmax, m.x0, m.dx));
  const double north = std::floor(line_at(r.ymax, m.y0, m.dy)), south = std::ceil(line_at(r.ymin, m.y0, m.dy));
  const GridRect& e = d.extent;
  const double first_col = std::max<double>(west, e.first.col), last_col = std::min<double>(east, e.last.col);
  const double first_row = std::max<double>(north, e.first.row), last_row = std::min<double>(south, e.last.row);
  const bool thin =
      e.first.col == e.last.col || e.first.row == e.last.row;  // a raster one sample wide has no area anyway
  if (first_col > last_col || first_row > last_row || (!thin && (first_col == last_col || first_row == last_row))) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("rectangle {}: nothing in common with the raster, whose samples span {},{},{},{}", text,
                              m.x(e.first.col), m.y(e.last.row), m.x(e.last.col), m.y(e.first.row)));
  }
  return {{static_cast<std::int32_t>(first_col), static_cast<std::int32_t>(first_row)},
          {static_cast<std::int32_t>(last_col), static_cast<std::int32_t>(last_row)}};
}

Answer Snapshot::range(GridRect region, Metres tolerance) const {
  return range_query(view_->pages, region, tolerance, view_->threads);
}

bool Snapshot::is_cut(const Rectangle& asked) const {
  static_cast<void>(region(asked));
  const Rectangle r = view_->pages.longitudes().among(asked);
  const GridMapping& m = description().mapping;
  const GridRect& e = description().extent;
  constexpr double kCell = 0.5 + 1e-6;  // samples are the middles of cells
  return line_at(r.xmin, m.x0, m.dx) < e.first.col - kCell || line_at(r.xmax, m.x0, m.dx) > e.last.col + kCell ||
         line_at(r.ymax, m.y0, m.dy) < e.first.row - kCell || line_at(r.ymin, m.y0, m.dy) > e.last.row + kCell;
}

Frame Snapshot::frame(const Rectangle& asked) const {
  static_cast<void>(region(asked));
  const Rectangle r = view_->pages.longitudes().among(asked);
  const GridMapping& m = description().mapping;
  const GridRect& e = description().extent;
  const auto col = [&](double x) { return std::clamp<double>(line_at(x, m.x0, m.dx), e.first.col, e.last.col); };
  const auto row = [&](double y) { return std::clamp<double>(line_at(y, m.y0, m.dy), e.first.row, e.last.row); };
  return {col(r.xmin), row(r.ymax), col(r.xmax), row(r.ymin)};
}

Increment Snapshot::increment(GridRect region, Metres from, Metres to) const {
  return increment_query(view_->pages, region, from, to, view_->threads);
}

std::vector<double> Snapshot::errors(const RestrictedQuadtree& answer) const {
  return vertex_errors(view_->pages, answer);
}

Identity Snapshot::identity() const { return view_->pages.identity(); }

Answer Snapshot::ask(const Question& question) const {
  require_sense(view_->pages, question);
  const bool is_plain = question.border == Border::constrain && !question.field && question.points.empty() &&
                        question.neighbours.empty() && question.max_level >= finest_level(description().extent);
  if (is_plain) return range(question.region, question.tolerance);
  return select_and_gather(view_->pages, question);
}

Answer Snapshot::bounded(GridRect region, Metres tolerance, Metres quantum) const {
  require_inside(view_->pages, region);
  require_tolerance(tolerance);
  return bounded_answer(*this, region, tolerance, quantum);
}

Answer Snapshot::fitted(GridRect region, Metres tolerance, Metres quantum) const {
  require_inside(view_->pages, region);
  require_tolerance(tolerance);
  return fitted_answer(*this, region, tolerance, quantum);
}

Answer Snapshot::dense(GridRect region, Metres tolerance) const {
  require_tolerance(tolerance);
  return dense_answer(*this, region, tolerance);
}

Answer Snapshot::quantised(GridRect region, Metres tolerance, Metres quantum) const {
  require_tolerance(tolerance);
  return quantised_answer(*this, region, tolerance, quantum);
}

Increment Snapshot::quantised_increment(GridRect region, Metres from, Metres to, Metres quantum) const {
  return talus::quantised_increment(*this, region, from, to, quantum);
}

std::vector<Answer> Snapshot::ask_together(std::span<const Question> patches) const {
  for (const Question& question : patches) {
    require_sense(view_->pages, question);
    if (question.border != Border::constrain)
      throw Failure(Cause::invalid_argument, "patches that meet in vertices have constrained borders");
  }
  return select_and_gather(view_->pages, patches);
}

Metres Snapshot::tolerance_for(GridRect region, const Budget& budget) const {
  QueryCost unused;
  return tolerance_for(region, budget, unused);
}

Metres Snapshot::tolerance_for(GridRect region, const Budget& budget, QueryCost& cost) const {
  return talus::tolerance_for(view_->pages, region, budget, cost);
}

Mesh Snapshot::mesh(Metres tolerance) const {
  return triangulate(range(description().extent, tolerance).quadtree, view_->threads);
}

Mesh Snapshot::mesh(const Rectangle& rectangle, Metres tolerance) const {
  return triangulate(range(region(rectangle), tolerance).quadtree, view_->threads);
}

namespace {

void require_room(std::size_t points, std::size_t room) {
  if (points == room) return;
  throw Failure(Cause::invalid_argument,
                fmt::format("{} points, and room for {} heights: expected as many", points, room));
}

}  // namespace

std::optional<double> Snapshot::height(double x, double y) const {
  const Position point{x, y};
  std::optional<double> height;
  heights({&point, 1}, {&height, 1});
  return height;
}

std::optional<double> Snapshot::height(double x, double y, Metres tolerance) const {
  const Position point{x, y};
  std::optional<double> height;
  heights({&point, 1}, tolerance, {&height, 1});
  return height;
}

QueryCost Snapshot::heights(std::span<const Position> points, std::span<std::optional<double>> out) const {
  require_room(points.size(), out.size());
  return sampled_heights(view_->pages, points, out);
}

QueryCost Snapshot::heights(std::span<const Position> points, Metres tolerance,
                            std::span<std::optional<double>> out) const {
  require_room(points.size(), out.size());
  return surface_heights(view_->pages, view_->pages.extent_border(), tolerance, points, out);
}

bool Snapshot::is_inside(Position point) const {
  const GridRect& extent = description().extent;
  return contains(extent, grid_place(description().mapping, view_->pages.longitudes().among(point, extent)));
}

Profile Snapshot::profile(std::span<const Position> line, Metres tolerance) const {
  return talus::profile(view_->pages, view_->pages.extent_border(), line, tolerance);
}

SampleWindow Snapshot::samples(GridRect region) const {
  if (const double finest = description().finest_tolerance; finest > 0) {
    throw Failure(Cause::unsupported,
                  fmt::format("the database keeps only the vertices of answers at {} m and more: it cannot restore "
                              "samples; ask for a surface at that tolerance",
                              finest));
  }
  return stored_samples(view_->pages, region).window;
}

}  // namespace talus
