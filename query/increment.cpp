// The walk is that of range_query, with two thresholds instead of one and without the pages of the border. They must agree to
// the bit on what counts in the bound: of pages with nothing above the finer tolerance their entries, of all others the
// vertices in the region.

#include "query/increment.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "engine/border.hpp"
#include "query/found.hpp"
#include "query/page_fates.hpp"
#include "query/question.hpp"

namespace talus {
namespace {

class IncrementQuery {
 public:
  IncrementQuery(const StoredPages& pages, GridRect region, Metres from, Metres to)
      : pages_(pages),
        manifest_(pages.manifest()),
        region_(region),
        from_(from),
        to_(to),
        above_from_(left_of(from), pages.distance()),
        above_to_(left_of(to), pages.distance()),
        forced_(region),
        vertices_(region),
        levels_(manifest_.description.extent),
        cost_(pages.cost_of_header()),
        fates_(pages, region, cost_),
        found_(pages, cost_) {}

  Increment run() {
    const auto started = std::chrono::steady_clock::now();
    fates_.begin();
    for (const GridPoint p : border_vertices(region_, root_side(manifest_.description.extent))) forced_.insert(p);
    const auto tops = pages_of_band(manifest_.bands - 1, manifest_.description.extent);
    for (std::size_t i = 0; i < tops.size(); ++i) {
      if (overlap(page_square(tops[i]), region_)) visit(tops[i], manifest_.top_generations[i]);
    }
    Increment increment;
    increment.added = found_.quadtree(region_, std::move(vertices_));
    increment.added.tolerance = to_;
    increment.added.bound = bound_of(pages_, absent_, left_of(to_));
    increment.added.level_errors = levels_.metres(pages_);
    increment.added.origin = {pages_.identity(), Border::constrain, true};
    increment.from = from_;
    increment.cost = cost_;
    increment.cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return increment;
  }

 private:
  /// What stored heights leave of a tolerance.
  [[nodiscard]] double left_of(Metres asked) const {
    const Description& d = manifest_.description;
    return std::max(d.kept_above(), asked.value - d.lossy_metres);
  }

  void visit(PageId id, std::uint32_t generation) {
    const Page& page = pages_.get(id, generation, decoder_, cost_);
    fates_.look_into(page, true);
    select(page);
    const std::vector<ChildEntry> children = page.children;  // the page's memory is the next page's
    for (std::size_t i = 0; i < children.size(); ++i) {
      const PageId child = child_page(id, i);
      const ChildEntry& entry = children[i];
      if (!entry.present || !overlap(page_square(child), region_)) continue;
      if (above_to_(entry.largest)) {
        visit(child, entry.generation);
      } else {
        absent_.code = std::max(absent_.code, entry.largest);
      }
    }
  }

  void select(const Page& page) {
    found_.begin_page();
    for_each_in(page.grid, region_, [&](std::int32_t col, std::int32_t row) {
      const std::size_t i = page.index(col, row);
      const GridPoint p = page.grid.at(col, row);
      if (!above_to_(page, i)) {
        if (page.is_own(p) && !forced_.contains(p)) absent_.take(page, i);
      } else if (!above_from_(page, i) && !forced_.contains(p)) {
        levels_.take(page, i, p);
        vertices_.insert(p);
        found_.take(page, col, row);
      }
    });
  }

  const StoredPages& pages_;
  const Manifest& manifest_;
  GridRect region_;
  Metres from_, to_;
  Above above_from_, above_to_;
  VertexMask forced_, vertices_;
  PageDecoder decoder_;
  LargestAbsent absent_;
  LargestByLevel levels_;
  QueryCost cost_;
  PageFates fates_;
  FoundVertices found_;
};

}  // namespace

Increment increment_query(const StoredPages& pages, GridRect region, Metres from, Metres to) {
  require_inside(pages, region);
  require_tolerance(from);
  require_tolerance(to);
  if (!(to < from)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("increment from {} m to {} m: expected `to`, the finer tolerance, below `from`", from.value,
                              to.value));
  }
  return IncrementQuery(pages, region, from, to).run();
}

}  // namespace talus
