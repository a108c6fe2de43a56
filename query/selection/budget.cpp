#include "query/selection/budget.hpp"

#include <cmath>
#include <limits>
#include <queue>
#include <tuple>
#include <unordered_set>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/border.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "query/pages/nearby_pages.hpp"
#include "query/pages/page_descent.hpp"
#include "query/pages/stopwatch.hpp"
#include "query/selection/answer_builder.hpp"
#include "query/selection/refusals.hpp"
#include "talus/quadtree.hpp"

namespace talus {
namespace {

/// Counts the vertices and triangles that each error code adds to an answer. It reads pages with the largest errors
/// first, and stops when the codes above all other pages are over budget.
class Fitting {
 public:
  Fitting(const StoredPages& pages, GridRect region, const Budget& budget, QueryCost& cost, Watch& watch)
      : pages_(pages), region_(region), budget_(budget), cost_(cost), watch_(watch) {}

  Metres run() {
    count_border();
    for_each_top(pages_.manifest(), region_, [&](PageId top, std::uint32_t generation) {
      waiting_.push({kAlwaysSelected, top, generation});
    });
    std::uint64_t counted = 0;
    while (!waiting_.empty() && !is_over_from(waiting_.top().largest)) {
      watch_.look();
      ++counted;
      watch_.tell(static_cast<double>(counted) / static_cast<double>(counted + waiting_.size()));
      const Waiting next = waiting_.top();
      waiting_.pop();
      count(*pages_.shared(next.id, next.generation, cost_));
    }
    return tolerance_of(smallest_that_fits());
  }

 private:
  struct Waiting {
    ErrorCode largest;
    PageId id;
    std::uint32_t generation;
    friend bool operator<(const Waiting& a, const Waiting& b) {
      return std::tuple(a.largest, -a.id.band, a.id.x, a.id.y) < std::tuple(b.largest, -b.id.band, b.id.x, b.id.y);
    }
  };
  struct Sum {
    std::uint64_t vertices = 0, triangles = 0;
    void add(const Sum& s) { vertices += s.vertices, triangles += s.triangles; }
  };

  /// Counts what every answer has: the stored vertices of the border, the root corner, and their triangles.
  void count_border() {
    VertexMask mask(region_);
    AnswerBuilder found(pages_, cost_);
    std::vector<GridPoint> needed = border_vertices(region_, root_side(pages_.manifest().description.extent));
    if (region_.contains({0, 0})) needed.push_back({0, 0});  // every tolerance selects the root corner
    for (const GridPoint p : needed) {
      if (!forced_.insert(key(p)).second) continue;
      const Page* page = nearby_.page_of_vertex(p);
      if (page == nullptr) continue;
      found.begin_page();
      found.take(*page, page->index(p), p);
      mask.insert(p);
    }
    const RestrictedQuadtree border = found.quadtree(region_, std::move(mask));
    border_ = {border.vertices.size(), triangulate(border).triangles.size()};
    if (!fits(border_)) {
      refuse(
          "budget of {}: the border of the region alone needs {} vertices and {} triangles; ask for more, or for a "
          "region on multiples of 16 samples (snapped()), which needs fewest",
          budget_text(), border_.vertices, border_.triangles);
    }
  }

  [[nodiscard]] std::string budget_text() const {
    std::string text;
    if (budget_.vertices > 0) text = fmt::format("{} vertices", budget_.vertices);
    if (budget_.triangles > 0) text += fmt::format("{}{} triangles", text.empty() ? "" : " and ", budget_.triangles);
    return text;
  }
  [[nodiscard]] bool fits(const Sum& s) const {
    return (budget_.vertices == 0 || s.vertices <= budget_.vertices) &&
           (budget_.triangles == 0 || s.triangles <= budget_.triangles);
  }

  void count(const Page& page) {
    for_each_in(page.grid, region_, [&](std::size_t i, GridPoint p) {
      if (!page.is_own(p)) return;
      const ErrorCode code = error_code(page.error_m(i, pages_.distance()));
      if (code > 0 && !forced_.contains(key(p))) by_code_[code].add({1, triangles_added(page, i, p)});
    });
    for_each_child(page, region_, [&](PageId child, const ChildEntry& entry) {
      waiting_.push({entry.largest, child, entry.generation});
    });
  }

  /// A vertex splits each half of its diamond in two, which adds a triangle if both parts hold data. A half that leaves
  /// the region is never a triangle of an answer.
  [[nodiscard]] std::uint64_t triangles_added(const Page& page, std::size_t i, GridPoint p) const {
    const unsigned covers = page.covers.empty() ? 15u : page.covers[i];
    std::uint64_t added = 0;
    for (const int side : {0, 1}) {
      if (inside(half_diamond(p, side), region_) && (covers >> (2 * side) & 3) == 3) ++added;
    }
    return added;
  }

  /// Whether the vertices with codes above `least` are over budget: the tolerance that fits is then `least` or above.
  /// All vertices with such codes were counted.
  [[nodiscard]] bool is_over_from(ErrorCode least) const {
    Sum sum = border_;
    for (std::size_t code = by_code_.size(); code-- > least + 1u;) sum.add(by_code_[code]);
    return !fits(sum);
  }

  [[nodiscard]] ErrorCode smallest_that_fits() const {
    Sum sum = border_;
    for (std::size_t code = by_code_.size(); code-- > 0;) {
      sum.add(by_code_[code]);
      if (!fits(sum)) return static_cast<ErrorCode>(code);
    }
    return 0;
  }

  /// The rung of a code plus the loss. Where the sum rounds down and excludes the code, the next double above it.
  [[nodiscard]] Metres tolerance_of(ErrorCode code) const {
    const double lossy = pages_.manifest().description.lossy.value;
    double tolerance = error_of(code) + lossy;
    while (largest_code_within(tolerance - lossy) < code)
      tolerance = std::nextafter(tolerance, std::numeric_limits<double>::infinity());
    return Metres{tolerance};
  }

  static std::uint64_t key(GridPoint p) {
    return std::uint64_t{static_cast<std::uint32_t>(p.col)} << 32 | static_cast<std::uint32_t>(p.row);
  }

  const StoredPages& pages_;
  GridRect region_;
  const Budget& budget_;
  QueryCost& cost_;
  Watch& watch_;
  NearbyPages nearby_{pages_, cost_, watch_};
  std::unordered_set<std::uint64_t> forced_;
  Sum border_;
  std::priority_queue<Waiting> waiting_;
  std::vector<Sum> by_code_ = std::vector<Sum>(kAlwaysSelected + 1u);  ///< without the border's vertices
};

}  // namespace

Metres tolerance_for(const StoredPages& pages, GridRect region, const Budget& budget, QueryCost& cost, Watch& watch) {
  require_inside(pages, region);
  if (budget.vertices == 0 && budget.triangles == 0) return Metres{0};
  cost = pages.cost_of_header();
  const Stopwatch running(cost.seconds);
  return Fitting(pages, region, budget, cost, watch).run();
}

}  // namespace talus
