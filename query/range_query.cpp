#include "query/range_query.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "engine/border.hpp"
#include "query/found.hpp"
#include "query/page_fates.hpp"
#include "query/question.hpp"

namespace talus {
namespace {

class RangeQuery {
 public:
  RangeQuery(const StoredPages& pages, GridRect region, Metres tolerance)
      : pages_(pages),
        manifest_(pages.manifest()),
        region_(region),
        asked_(tolerance.value),
        lossy_(manifest_.description.lossy_metres),
        tolerance_(std::max(manifest_.description.kept_above(), tolerance.value - lossy_)),
        above_(tolerance_, pages.distance()),
        vertices_(region),
        levels_(manifest_.description.extent),
        cost_(pages.cost_of_header()),
        fates_(pages, region, cost_),
        found_(pages, cost_) {}

  Answer run() {
    const auto started = std::chrono::steady_clock::now();
    force_border();
    const auto tops = pages_of_band(manifest_.bands - 1, manifest_.description.extent);
    for (std::size_t i = 0; i < tops.size(); ++i) {
      if (overlap(page_square(tops[i]), region_)) visit(tops[i], manifest_.top_generations[i], true);
    }
    Answer answer;
    answer.border_vertices = forced_alone_;
    answer.quadtree = found_.quadtree(region_, std::move(vertices_));
    answer.quadtree.tolerance = Metres{asked_};
    answer.quadtree.bound = bound_of(pages_, absent_, tolerance_);
    answer.quadtree.level_errors = levels_.metres(pages_);
    answer.quadtree.origin = {pages_.identity(), Border::constrain, true};
    answer.cost = cost_;
    answer.cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return answer;
  }

 private:
  using PageKeyPair = std::pair<int, std::uint64_t>;

  /// Selects what the border needs, and marks the pages that hold it and all pages above them.
  void force_border() {
    for (const GridPoint p : border_vertices(region_, root_side(manifest_.description.extent))) {
      vertices_.insert(p);
      ++forced_alone_;
      for (PageId id = page_of(p, band_of(p, manifest_.bands)); id.band < manifest_.bands; id = parent_page(id)) {
        if (!forced_pages_.emplace(id.band, curve_position(id)).second) break;
      }
    }
  }
  [[nodiscard]] bool is_forced(PageId id) const { return forced_pages_.contains({id.band, curve_position(id)}); }

  void visit(PageId id, std::uint32_t generation, bool is_wanted) {
    const Page& page = pages_.get(id, generation, decoder_, cost_);
    fates_.look_into(page, is_wanted);
    select(page);
    const std::vector<ChildEntry> children = page.children;  // the page's memory is the next page's
    for (std::size_t i = 0; i < children.size(); ++i) {
      const PageId child = child_page(id, i);
      const ChildEntry& entry = children[i];
      if (!entry.present || !overlap(page_square(child), region_)) continue;
      // A page with nothing above the tolerance counts in the bound as its entry says, though the border may need it and more
      // be known then: so increments, which do not read it, have the same bound.
      const bool wanted = above_(entry.largest);
      if (!wanted) absent_.code = std::max(absent_.code, entry.largest);
      if (wanted || is_forced(child)) visit(child, entry.generation, wanted);
    }
  }

  /// Takes the page's own vertices whose error is above the tolerance, or that the border needs.
  void select(const Page& page) {
    const PageGrid& grid = page.grid;
    const auto [first, last] = samples_in(grid, region_);
    const bool forced = is_forced(page.id);
    found_.begin_page();
    const ErrorCode threshold = above_.code();
    ErrorCode absent_code = absent_.code;
    // Of every sample: is its distance above the tolerance, or its code? Samples that are no vertices of this band
    // have neither.
    const auto look = [&](auto&& distance_of, auto largest_within) {
      auto largest_absent = largest_within;
      largest_absent = -1;
      for (std::int32_t row = first.row; row <= last.row; ++row) {
        for (std::int32_t col = first.col; col <= last.col; ++col) {
          const std::size_t i = page.index(col, row);
          const ErrorCode code = page.errors[i];
          const auto distance = distance_of(i);
          const bool above = distance > largest_within || code > threshold;
          if (above || (forced && page.is_own(grid.at(col, row)) && vertices_.contains(grid.at(col, row)))) {
            take(page, col, row, above, forced);
          } else {
            absent_code = std::max(absent_code, code);
            largest_absent = std::max(largest_absent, distance);
          }
        }
      }
      return static_cast<double>(largest_absent);
    };
    double absent = -1;
    if (!page.eighths.empty()) {
      absent = look([&](std::size_t i) { return page.eighths[i]; }, above_.eighths()) / 8;
    } else if (!page.distances.empty()) {
      absent = look([&](std::size_t i) { return page.distances[i]; }, above_.distance());
    } else {
      look([](std::size_t) { return -1; }, 0);
    }
    absent_.code = absent_code;
    absent_.distance = std::max(absent_.distance, absent);
  }

  void take(const Page& page, std::int32_t col, std::int32_t row, bool above, bool may_be_forced) {
    const GridPoint p = page.grid.at(col, row);
    if (!may_be_forced || !vertices_.contains(p)) {
      levels_.take(page, page.index(col, row), p);
      vertices_.insert(p);
    } else if (above) {
      --forced_alone_;
    }
    found_.take(page, col, row);
  }

  const StoredPages& pages_;
  const Manifest& manifest_;
  GridRect region_;
  double asked_;
  double lossy_;      ///< how far stored heights may lie from the source's
  double tolerance_;  ///< what is left of the one asked for
  Above above_;
  VertexMask vertices_;
  std::set<PageKeyPair> forced_pages_;
  PageDecoder decoder_;
  LargestAbsent absent_;
  LargestByLevel levels_;
  std::uint64_t forced_alone_ = 0;  ///< vertices that only the border needs
  QueryCost cost_;
  PageFates fates_;
  FoundVertices found_;
};

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
  require_tolerance(tolerance);
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
