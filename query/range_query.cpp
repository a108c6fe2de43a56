#include "query/range_query.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "engine/border.hpp"

namespace talus {
namespace {

/// Nanometres by which doubles miss decimal heights; part of the bound where a step is no binary fraction.
constexpr double kDecimalRounding = 1e-9;

class RangeQuery {
 public:
  RangeQuery(const StoredPages& pages, GridRect region, Metres tolerance)
      : pages_(pages), manifest_(pages.manifest()), region_(region), tolerance_(tolerance.value),
        threshold_(largest_code_within(tolerance.value)), forced_(region), cost_(pages.cost_of_header()) {}

  Answer run() {
    const auto started = std::chrono::steady_clock::now();
    force_border();
    const int top = manifest_.bands - 1;
    for (const PageId id : pages_of_band(top, manifest_.description.extent)) {
      if (overlap(page_square(id), region_)) visit(id);
    }
    Answer answer{collect(), cost_};
    answer.cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return answer;
  }

 private:
  struct Found {
    GridPoint at;
    double height;
    std::uint8_t covers;
  };

  /// Marks what the border needs, and the pages that hold it with all pages above them.
  void force_border() {
    for (const GridPoint p : border_vertices(region_, root_side(manifest_.description.extent))) {
      forced_.insert(p);
      for (PageId id = page_of(p, band_of(p, manifest_.bands)); id.band < manifest_.bands; id = parent_page(id)) {
        if (!forced_pages_.emplace(id.band, curve_position(id)).second) break;
      }
    }
  }

  void visit(PageId id) {
    const auto page = pages_.find(id, cost_);
    if (!page) return;  // voids only: no triangle needs it
    select(*page);
    for (std::size_t i = 0; i < page->children.size(); ++i) {
      const auto x = static_cast<std::int32_t>(i) % kChildrenAcross, y = static_cast<std::int32_t>(i) / kChildrenAcross;
      const PageId child{id.band - 1, id.x * kChildrenAcross + x, id.y * kChildrenAcross + y};
      const ChildEntry& entry = page->children[i];
      if (!entry.present || !overlap(page_square(child), region_)) continue;
      if (entry.largest > threshold_ || forced_pages_.contains({child.band, curve_position(child)})) {
        visit(child);
      } else {
        bound_ = std::max(bound_, error_of(entry.largest));
      }
    }
  }

  /// Takes the page's own vertices whose error is above the tolerance, or that the border needs.
  void select(const Page& page) {
    const PageGrid& grid = page.grid;
    const auto units = [&](std::int32_t v, bool up) { return static_cast<std::int32_t>((std::int64_t{v} + (up ? (1 << grid.shift) - 1 : 0)) >> grid.shift); };
    const std::int32_t first_col = std::max(units(region_.first.col, true) - grid.first.col, 0);
    const std::int32_t first_row = std::max(units(region_.first.row, true) - grid.first.row, 0);
    const std::int32_t last_col = std::min(units(region_.last.col, false) - grid.first.col, grid.cols - 1);
    const std::int32_t last_row = std::min(units(region_.last.row, false) - grid.first.row, grid.rows - 1);
    for (std::int32_t row = first_row; row <= last_row; ++row) {
      for (std::int32_t col = first_col; col <= last_col; ++col) {
        const GridPoint p = grid.at(col, row);
        if (!page.is_own(p)) continue;
        const std::size_t i = page.index(col, row);
        double error = 0;
        bool above = false;
        if (page.is_implied(p, col, row)) {
          error = page.implied_error(p, col, row, pages_.distance(), manifest_.exact);
          above = error > tolerance_;
        } else {
          above = page.errors[i] > threshold_;
          error = error_of(page.errors[i]);
        }
        if (above || forced_.contains(p)) {
          found_.push_back({p, page.heights[i], page.covers.empty() ? std::uint8_t{15} : page.covers[i]});
        } else {
          bound_ = std::max(bound_, error);
        }
      }
    }
  }

  RestrictedQuadtree collect() const {
    RestrictedQuadtree answer;
    answer.tolerance = Metres{tolerance_};
    answer.bound = Metres{bound_ + (pages_.distance().is_binary() && manifest_.exact ? 0 : kDecimalRounding)};
    answer.vertices = VertexMask(region_);
    bool all_covered = true;
    for (const Found& f : found_) {
      answer.vertices.insert(f.at);
      all_covered = all_covered && f.covers == 15;
    }
    answer.vertices.seal();
    answer.heights.resize(found_.size());
    if (!all_covered) answer.covers.resize(found_.size());
    const HeightStep& step = manifest_.description.step;
    for (const Found& f : found_) {
      const std::uint32_t rank = answer.vertices.rank(f.at);
      answer.heights[rank] = step.value(f.height);
      if (!all_covered) answer.covers[rank] = f.covers;
    }
    return answer;
  }

  const StoredPages& pages_;
  const Manifest& manifest_;
  GridRect region_;
  double tolerance_;
  ErrorCode threshold_;
  VertexMask forced_;
  std::set<std::pair<int, std::uint64_t>> forced_pages_;
  std::vector<Found> found_;
  double bound_ = 0;
  QueryCost cost_;
};

void require_inside(const StoredPages& pages, GridRect region) {
  const GridRect& extent = pages.manifest().description.extent;
  if (region.cols() < 1 || region.rows() < 1 || !extent.contains(region.first) || !extent.contains(region.last)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("region of columns {} to {}, rows {} to {}: expected one within columns {} to {}, rows {} to {}",
                              region.first.col, region.last.col, region.first.row, region.last.row, extent.first.col,
                              extent.last.col, extent.first.row, extent.last.row));
  }
}

}  // namespace

Answer range_query(const StoredPages& pages, GridRect region, Metres tolerance) {
  require_inside(pages, region);
  if (!(tolerance.value >= 0)) {
    throw Failure(Cause::invalid_argument, fmt::format("tolerance {} m: expected a number of metres, 0 or more", tolerance.value));
  }
  return RangeQuery(pages, region, tolerance).run();
}

SampleWindow stored_samples(const StoredPages& pages, GridRect region) {
  require_inside(pages, region);
  SampleWindow window;
  window.region = region;
  window.values.assign(static_cast<std::size_t>(region.samples()), 0);
  window.valid.assign(window.values.size(), 0);
  const HeightStep& step = pages.manifest().description.step;
  QueryCost unused;
  for (const PageId id : pages_of_band(0, region)) {
    const auto page = pages.find(id, unused);
    if (!page) continue;
    for (std::int32_t row = 0; row < page->grid.rows; ++row) {
      for (std::int32_t col = 0; col < page->grid.cols; ++col) {
        const GridPoint p = page->grid.at(col, row);
        const std::size_t from = page->index(col, row);
        if (!region.contains(p) || (!page->valid.empty() && !page->valid[from])) continue;
        const std::size_t to = window.index(p);
        window.values[to] = step.value(page->heights[from]);
        window.valid[to] = 1;
      }
    }
  }
  return window;
}

}  // namespace talus
