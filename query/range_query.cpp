#include "query/range_query.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "engine/border.hpp"
#include "query/kept_heights.hpp"

namespace talus {
namespace {

/// More metres than doubles miss decimal heights by; part of the bound where a step is no binary fraction.
constexpr double kDecimalRounding = 1e-9;

/// The largest distance in height codes that is still within a tolerance; -1 if none is.
double largest_distance_within(double tolerance_m, const CodeDistance& distance) {
  const auto within = [&](double codes) { return distance.metres(codes) <= tolerance_m; };
  double low = 0, high = std::numeric_limits<double>::max();
  if (!within(0)) return -1;
  if (within(high)) return high;
  for (double middle = 1;; middle = low + (high - low) / 2) {
    if (middle <= low || middle >= high) return low;
    (within(middle) ? low : high) = middle;
  }
}

/// The same in eighths of a code.
std::int32_t largest_eighths_within(double largest_distance) {
  if (largest_distance < 0) return -1;
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  return largest_distance < kMost / 8 ? static_cast<std::int32_t>(largest_distance * 8) : kMost;
}

class RangeQuery {
 public:
  RangeQuery(const StoredPages& pages, GridRect region, Metres tolerance)
      : pages_(pages),
        manifest_(pages.manifest()),
        region_(region),
        asked_(tolerance.value),
        lossy_(manifest_.description.lossy_metres),
        tolerance_(std::max(manifest_.description.kept_above(), tolerance.value - lossy_)),
        threshold_(largest_code_within(tolerance_)),
        largest_distance_(largest_distance_within(tolerance_, pages.distance())),
        largest_eighths_(largest_eighths_within(largest_distance_)),
        vertices_(region),
        cost_(pages.cost_of_header()),
        kept_heights_(pages, cost_) {}

  Answer run() {
    const auto started = std::chrono::steady_clock::now();
    force_border();
    const auto tops = pages_of_band(manifest_.bands - 1, manifest_.description.extent);
    for (std::size_t i = 0; i < tops.size(); ++i) {
      if (overlap(page_square(tops[i]), region_)) visit(tops[i], manifest_.top_generations[i]);
    }
    Answer answer{collect(), cost_};
    answer.cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return answer;
  }

 private:
  /// The selected vertices of a page.
  struct Found {
    std::vector<GridPoint> at;
    std::vector<double> heights;
    std::vector<std::uint8_t> covers;  ///< empty: all 15
  };
  using PageKeyPair = std::pair<int, std::uint64_t>;

  /// Selects what the border needs, and marks the pages that hold it and all pages above them.
  void force_border() {
    for (const GridPoint p : border_vertices(region_, root_side(manifest_.description.extent))) {
      vertices_.insert(p);
      for (PageId id = page_of(p, band_of(p, manifest_.bands)); id.band < manifest_.bands; id = parent_page(id)) {
        if (!forced_pages_.emplace(id.band, curve_position(id)).second) break;
      }
    }
  }
  [[nodiscard]] bool is_forced(PageId id) const { return forced_pages_.contains({id.band, curve_position(id)}); }

  void visit(PageId id, std::uint32_t generation) {
    const Page& page = pages_.get(id, generation, decoder_, cost_);
    select(page);
    const std::vector<ChildEntry> children = page.children;  // the page's memory is the next page's
    for (std::size_t i = 0; i < children.size(); ++i) {
      const PageId child = child_page(id, i);
      const ChildEntry& entry = children[i];
      if (!entry.present || !overlap(page_square(child), region_)) continue;
      if (entry.largest > threshold_ || is_forced(child)) {
        visit(child, entry.generation);
      } else {
        largest_absent_ = std::max(largest_absent_, entry.largest);
      }
    }
  }

  /// Takes the page's own vertices whose error is above the tolerance, or that the border needs.
  void select(const Page& page) {
    const PageGrid& grid = page.grid;
    const std::int64_t ceil = (std::int64_t{1} << grid.shift) - 1;
    const auto first_unit = [&](std::int32_t v) { return static_cast<std::int32_t>((v + ceil) >> grid.shift); };
    const std::int32_t first_col = std::max(first_unit(region_.first.col) - grid.first.col, 0);
    const std::int32_t first_row = std::max(first_unit(region_.first.row) - grid.first.row, 0);
    const std::int32_t last_col = std::min((region_.last.col >> grid.shift) - grid.first.col, grid.cols - 1);
    const std::int32_t last_row = std::min((region_.last.row >> grid.shift) - grid.first.row, grid.rows - 1);
    const bool forced = is_forced(page.id);
    for_next_page();
    // Of every sample: is its distance above the tolerance, or its code? Samples that are no vertices of this band
    // have neither.
    const auto look = [&](auto&& distance_of, auto largest_within) {
      auto largest_absent = largest_within;
      largest_absent = -1;
      for (std::int32_t row = first_row; row <= last_row; ++row) {
        for (std::int32_t col = first_col; col <= last_col; ++col) {
          const std::size_t i = page.index(col, row);
          const ErrorCode code = page.errors[i];
          const auto distance = distance_of(i);
          const bool above = distance > largest_within || code > threshold_;
          if (above || (forced && page.is_own(grid.at(col, row)) && vertices_.contains(grid.at(col, row)))) {
            take(page, col, row);
          } else {
            largest_absent_ = std::max(largest_absent_, code);
            largest_absent = std::max(largest_absent, distance);
          }
        }
      }
      return static_cast<double>(largest_absent);
    };
    double absent = -1;
    if (!page.eighths.empty()) {
      absent = look([&](std::size_t i) { return page.eighths[i]; }, largest_eighths_) / 8;
    } else if (!page.distances.empty()) {
      absent = look([&](std::size_t i) { return page.distances[i]; }, largest_distance_);
    } else {
      look([](std::size_t) { return -1; }, 0);
    }
    largest_absent_distance_ = std::max(largest_absent_distance_, absent);
    found_.push_back(here_);
  }

  void take(const Page& page, std::int32_t col, std::int32_t row) {
    const GridPoint p = page.grid.at(col, row);
    const std::size_t i = page.index(col, row);
    vertices_.insert(p);
    here_.at.push_back(p);
    here_.heights.push_back(kept_heights_.is_kept(page, col, row) ? page.heights[i] : kept_heights_.at(p));
    if (!page.covers.empty()) here_.covers.push_back(page.covers[i]);
  }

  void for_next_page() {
    here_.at.clear();
    here_.heights.clear();
    here_.covers.clear();
  }

  RestrictedQuadtree collect() {
    RestrictedQuadtree answer;
    answer.tolerance = Metres{asked_};
    answer.bound = Metres{bound()};
    std::size_t count = 0;
    bool all_covered = true;
    for (const Found& page : found_) {
      count += page.at.size();
      all_covered =
          all_covered && std::all_of(page.covers.begin(), page.covers.end(), [](std::uint8_t c) { return c == 15; });
    }
    keep_found_only(count);
    answer.heights.resize(count);
    if (!all_covered) answer.covers.resize(count, 15);
    const HeightStep& step = manifest_.description.step;
    std::vector<std::uint32_t> ranks;
    for (const Found& page : found_) {
      ranks.resize(page.at.size());
      vertices_.ranks(page.at, ranks);
      for (std::size_t i = 0; i < ranks.size(); ++i) answer.heights[ranks[i]] = step.value(page.heights[i]);
      for (std::size_t i = 0; !all_covered && i < page.covers.size(); ++i) answer.covers[ranks[i]] = page.covers[i];
    }
    answer.vertices = std::move(vertices_);
    return answer;
  }

  /// Border vertices amid voids may stand in pages that were never stored: nothing needs them.
  void keep_found_only(std::size_t count) {
    vertices_.seal();
    if (vertices_.size() == count) return;
    vertices_ = VertexMask(region_);
    for (const Found& page : found_) {
      for (const GridPoint p : page.at) vertices_.insert(p);
    }
    vertices_.seal();
  }

  [[nodiscard]] double bound() const {
    double metres = std::max(error_of(largest_absent_), manifest_.description.kept_above());
    if (largest_absent_distance_ >= 0) {
      metres = std::max(metres, std::min(tolerance_, pages_.distance().metres(largest_absent_distance_)));
    }
    const bool heights_are_exact = pages_.distance().is_binary() && manifest_.description.step.offset == 0 &&
                                   manifest_.description.finest_tolerance == 0;
    return metres + lossy_ + (heights_are_exact ? 0 : kDecimalRounding);
  }

  const StoredPages& pages_;
  const Manifest& manifest_;
  GridRect region_;
  double asked_;
  double lossy_;      ///< how far stored heights may lie from the source's
  double tolerance_;  ///< what is left of the one asked for
  ErrorCode threshold_;
  double largest_distance_;
  std::int32_t largest_eighths_;
  VertexMask vertices_;
  std::set<PageKeyPair> forced_pages_;
  std::vector<Found> found_;  // by page
  Found here_;
  PageDecoder decoder_;
  ErrorCode largest_absent_ = 0;
  double largest_absent_distance_ = -1;
  QueryCost cost_;
  KeptHeights kept_heights_;
};

void require_inside(const StoredPages& pages, GridRect region) {
  const GridRect& extent = pages.manifest().description.extent;
  if (region.cols() < 1 || region.rows() < 1 || !extent.contains(region.first) || !extent.contains(region.last)) {
    throw Failure(
        Cause::invalid_argument,
        fmt::format("region of columns {} to {}, rows {} to {}: expected one within columns {} to {}, rows {} to {}",
                    region.first.col, region.last.col, region.first.row, region.last.row, extent.first.col,
                    extent.last.col, extent.first.row, extent.last.row));
  }
}

void copy_samples(const Page& page, const HeightStep& step, StoredSamples& stored) {
  SampleWindow& to = stored.window;
  for (std::int32_t row = 0; row < page.grid.rows; ++row) {
    for (std::int32_t col = 0; col < page.grid.cols; ++col) {
      const GridPoint p = page.grid.at(col, row);
      const std::size_t i = page.index(col, row);
      if (!to.region.contains(p) || (!page.valid.empty() && !page.valid[i])) continue;
      to.values[to.index(p)] = step.value(page.heights[i]);
      to.valid[to.index(p)] = 1;
      if (page.is_dropped(col, row)) stored.dropped[to.index(p)] = 1;
    }
  }
}

}  // namespace

Answer range_query(const StoredPages& pages, GridRect region, Metres tolerance) {
  require_inside(pages, region);
  if (!(tolerance.value >= 0)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("tolerance {} m: expected a number of metres, 0 or more", tolerance.value));
  }
  return RangeQuery(pages, region, tolerance).run();
}

StoredSamples stored_samples(const StoredPages& pages, GridRect region) {
  require_inside(pages, region);
  StoredSamples stored;
  SampleWindow& window = stored.window;
  window.region = region;
  window.values.assign(static_cast<std::size_t>(region.samples()), 0);
  window.valid.assign(window.values.size(), 0);
  if (pages.manifest().description.finest_tolerance > 0) stored.dropped.assign(window.values.size(), 0);
  const HeightStep& step = pages.manifest().description.step;
  QueryCost unused;
  PageDecoder decoder;
  // From the top down: only a page above tells one that is missing from one that holds voids.
  const auto visit = [&](auto&& self, PageId id, std::uint32_t generation) -> void {
    const Page& page = pages.get_heights(id, generation, decoder, unused);
    const std::vector<ChildEntry> children = page.children;
    for (std::size_t i = 0; i < children.size(); ++i) {
      const PageId child = child_page(id, i);
      if (children[i].present && overlap(page_square(child), region)) self(self, child, children[i].generation);
    }
    if (id.band == 0) copy_samples(page, step, stored);
  };
  const Manifest& manifest = pages.manifest();
  const auto tops = pages_of_band(manifest.bands - 1, manifest.description.extent);
  for (std::size_t i = 0; i < tops.size(); ++i) {
    if (overlap(page_square(tops[i]), region)) visit(visit, tops[i], manifest.top_generations[i]);
  }
  return stored;
}

}  // namespace talus
