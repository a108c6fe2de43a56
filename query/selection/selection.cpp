#include "query/selection/selection.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <unordered_set>
#include <utility>

#include "engine/quadtree/border.hpp"
#include "engine/quadtree/construction.hpp"
#include "query/pages/nearby_pages.hpp"
#include "query/pages/page_descent.hpp"
#include "query/pages/page_fates.hpp"
#include "query/pages/stopwatch.hpp"
#include "query/selection/answer_builder.hpp"
#include "query/selection/cover.hpp"
#include "query/selection/matching.hpp"
#include "query/selection/threshold.hpp"

namespace talus {
namespace {

class Selection {
 public:
  Selection(const StoredPages& pages, const Question& question, Watch& watch)
      : pages_(pages), question_(question), watch_(watch) {}

  /// Selects the vertices that this question needs without its neighbours.
  void choose() {
    const Stopwatch running(cost_.seconds);
    watch_.stage("choosing vertices", 0, kChoosing);
    fates_.begin();
    choose_forced();
    for_each_top(pages_.manifest(), question_.region,
                 [&](PageId top, std::uint32_t generation) { choose(top, generation); });
    watch_.look();
    // One tolerance selects a set with all its parents. A tolerance that varies may not.
    if (question_.field) close_bottom_up(vertices_, root_);
    if (question_.points.empty()) return;
    for_points_ = insert_points();
    for_points_ += close_bottom_up(vertices_, root_);
  }

  [[nodiscard]] const GridRect& region() const { return question_.region; }
  [[nodiscard]] const VertexMask& vertices() const { return vertices_; }

  /// Adds a neighbour's vertices on shared sides, with all their parents. Returns whether any of them was new.
  bool match(GridRect neighbour, const VertexMask& its_vertices) {
    const Stopwatch running(cost_.seconds);
    watch_.look();
    std::uint64_t added = 0;
    for_each_on_shared_side(its_vertices, neighbour, question_.region, [&](GridPoint p) {
      if (vertices_.contains(p)) return;
      vertices_.insert(p);
      ++added;
    });
    if (added == 0) return false;
    matching_ += added + close_bottom_up(vertices_, root_);
    return true;
  }

  /// Reads the heights of the chosen vertices. Call it once, after choose() and match().
  Answer gather() {
    Answer answer;
    {
      const Stopwatch running(cost_.seconds);
      gather_into(answer);
    }
    answer.cost = cost_;
    return answer;
  }

 private:
  static constexpr double kChoosing = 0.6;  ///< share of the time that choosing takes

  void gather_into(Answer& answer) {
    watch_.stage("gathering heights", kChoosing, 1);
    gather_pages();
    answer.quadtree = found_.quadtree(question_.region, std::move(vertices_));
    answer.quadtree.tolerance = question_.field ? Metres{std::numeric_limits<double>::infinity()} : question_.tolerance;
    answer.quadtree.bound = bound_of(pages_, absent_, largest_tolerance());
    answer.quadtree.origin = {pages_.identity(), question_.border, false};
    answer.border_vertices = forced_alone_;
    answer.matching_vertices = matching_;
    answer.point_vertices = for_points_;
    answer.points = question_.points.size();
    answer.void_points = void_points_;
    for (const RestrictedQuadtree* neighbour : question_.neighbours) {
      for_each_on_shared_side(answer.quadtree.vertices, question_.region, neighbour->region, [&](GridPoint p) {
        if (!neighbour->vertices.contains(p)) answer.unmatched.push_back(p);
      });
    }
  }

  [[nodiscard]] double largest_tolerance() const {
    const bool by_tolerance = !question_.field && finest_height_ == 0;
    return by_tolerance ? std::max(kept_above_, question_.tolerance.value - lossy_)
                        : std::numeric_limits<double>::infinity();
  }

  void choose_forced() {
    std::vector<GridPoint> needed;
    GridRect window = question_.region;
    if (question_.border == Border::constrain) {
      needed = border_vertices(question_.region, root_);
    } else {
      const ExtentBorder& border = pages_.extent_border();
      VerticesAround outside = vertices_around(question_.region, extent_, finest_height_, above_, border, nearby_);
      for (const GridPoint p : outside.corners) {
        window = around(window, {p, p});
      }
      absent_ = outside.absent;
      needed = std::move(outside.corners);
      for (const GridPoint p : outside.splits) {
        if (window.contains(p)) needed.push_back(p);
      }
      for (const GridPoint p : border.vertices()) {
        if (question_.region.contains(p)) needed.push_back(p);
      }
    }
    watch_.look();
    watch_.add_bytes(bytes_of_mask(window));
    vertices_ = VertexMask(window);
    for (const GridPoint p : needed) {
      if (vertices_.contains(p)) continue;
      vertices_.insert(p);
      ++forced_alone_;
    }
  }

  /// Whether a page, or one below it, may have a vertex above the tolerance.
  [[nodiscard]] bool is_worth_reading(PageId id, const ChildEntry& entry) const {
    if (!question_.field) return above_(entry.largest);
    // A vertex is compared with the least tolerance in its diamond. No diamond of these pages leaves this square.
    const GridRect square = grown(common(page_square(id), question_.region), band_spacing(id.band + 1));
    return pages_.distance().up_to_eighths(entry.largest) > limit_in(square);
  }
  [[nodiscard]] double limit_in(GridRect rect) const {
    return std::max(kept_above_, question_.field->least(common(rect, extent_)).value - lossy_);
  }
  [[nodiscard]] bool is_selected(const Page& page, std::size_t i, GridPoint p) const {
    if (finest_height_ > 0 && height_in_tree(p) < finest_height_) return false;
    if (!question_.field) return above_(page, i);
    const double error = page.error_m(i, pages_.distance());
    return error > kept_above_ && error > limit_in(grown({p, p}, spacing(p)));
  }

  /// visit(i, p): visits the page's own vertices in a rectangle.
  template <class Visit>
  static void for_each_own(const Page& page, GridRect in, Visit&& visit) {
    for_each_in(page.grid, in, [&](std::size_t i, GridPoint p) {
      if (page.is_own(p)) visit(i, p);
    });
  }

  void choose(PageId id, std::uint32_t generation) {
    watch_.look();
    std::uint64_t selected = 0;
    const std::shared_ptr<const Page> page = pages_.shared(id, generation, cost_);
    look_into(*page, true);
    for_each_own(*page, question_.region, [&](std::size_t i, GridPoint p) {
      if (is_selected(*page, i, p)) {
        if (vertices_.contains(p)) --forced_alone_;
        vertices_.insert(p);
        ++selected;
      } else if (!vertices_.contains(p)) {
        absent_.take(*page, i);
      }
    });
    // All selected vertices are stored, so the answer has at least as many.
    selected_ += selected;
    watch_.require_vertices(selected_);
    ++pages_chosen_;
    watch_.tell(static_cast<double>(pages_chosen_) / static_cast<double>(pages_chosen_ + kPagesAhead));
    for_each_child(*page, question_.region, [&](PageId child, const ChildEntry& entry) {
      if (is_worth_reading(child, entry) && is_fine_enough(child)) {
        choose(child, entry.generation);
      } else {
        absent_.code = std::max(absent_.code, entry.largest);
      }
    });
  }
  /// Whether the page has a level that max_level allows.
  [[nodiscard]] bool is_fine_enough(PageId id) const { return band_shift(id.band + 1) > finest_height_; }

  void look_into(const Page& page, bool is_wanted) {
    const bool is_first = looked_into_[static_cast<std::size_t>(page.id.band)].insert(curve_position(page.id)).second;
    if (is_first) fates_.look_into(page, is_wanted);
  }

  /// Returns the number of new points. Void samples are left out, and counted in `void_points_`.
  std::uint64_t insert_points() {
    const int bands = pages_.manifest().bands;
    const auto place = [&](GridPoint p) {
      const PageId id = page_of(p, band_of(p, bands));
      return std::pair(id.band, curve_position(id));
    };
    std::vector<GridPoint> points = question_.points;  // sorted by page
    std::sort(points.begin(), points.end(), [&](GridPoint a, GridPoint b) { return place(a) < place(b); });
    std::uint64_t added = 0;
    for (const GridPoint p : points) {
      const Page* page = nearby_.page_of_vertex(p);
      if (page == nullptr || !page->is_data(page->index(p))) {
        ++void_points_;
      } else if (!vertices_.contains(p)) {
        vertices_.insert(p);
        ++added;
      }
    }
    return added;
  }

  void gather_pages() {
    const double reading_before = cost_.reading_seconds;
    {
      const Stopwatch gathering(cost_.gathering_seconds);
      mark_pages();
      for_each_top(pages_.manifest(), extent_, [&](PageId top, std::uint32_t generation) { gather(top, generation); });
    }
    cost_.gathering_seconds -= cost_.reading_seconds - reading_before;
  }

  /// Marks the pages of the chosen vertices, and all pages above them.
  void mark_pages() {
    const int bands = pages_.manifest().bands;
    std::vector<PageId> last(static_cast<std::size_t>(bands), PageId{-1, 0, 0});
    const auto mark = [&](GridPoint p) {
      PageId id = page_of(p, band_of(p, bands));
      for (; id.band < bands; id = parent_page(id)) {
        if (last[static_cast<std::size_t>(id.band)] == id) return;
        last[static_cast<std::size_t>(id.band)] = id;
        if (marked_[static_cast<std::size_t>(id.band)].insert(curve_position(id)).second) ++pages_marked_;
      }
    };
    vertices_.for_each(mark);
  }

  void gather(PageId id, std::uint32_t generation) {
    if (!marked_[static_cast<std::size_t>(id.band)].contains(curve_position(id))) return;
    watch_.look();
    const std::shared_ptr<const Page> page = pages_.shared(id, generation, cost_);
    look_into(*page, false);
    found_.begin_page();
    std::uint64_t taken = 0;
    for_each_own(*page, vertices_.region(), [&](std::size_t i, GridPoint p) {
      if (!vertices_.contains(p)) return;
      found_.take(*page, i, p);
      ++taken;
    });
    watch_.add_vertices(taken);
    watch_.tell(static_cast<double>(++pages_gathered_) / static_cast<double>(pages_marked_));
    for_each_child(*page, extent_, [&](PageId child, const ChildEntry& entry) { gather(child, entry.generation); });
  }

  /// Pages after which choosing counts as half done, because their number is not known beforehand.
  static constexpr std::uint64_t kPagesAhead = 64;

  const StoredPages& pages_;
  const Question& question_;
  Watch& watch_;
  const Description& description_ = pages_.manifest().description;
  GridRect extent_ = description_.extent;
  std::int32_t root_ = root_side(extent_);
  double kept_above_ = description_.kept_above().value;  ///< metres
  double lossy_ = description_.lossy.value;              ///< the loss, in metres
  Threshold above_{std::max(kept_above_, question_.tolerance.value - lossy_), pages_.distance()};
  /// log2 of the smallest spacing that max_level allows
  int finest_height_ = std::max(0, finest_level(extent_) - question_.max_level.value_or(finest_level(extent_)));
  QueryCost cost_ = pages_.cost_of_header();
  PageFates fates_{pages_, question_.region, cost_, finest_height_};
  NearbyPages nearby_{pages_, cost_, watch_};
  AnswerBuilder found_{pages_, cost_};
  VertexMask vertices_;
  std::uint64_t forced_alone_ = 0;  ///< vertices that only the border needs
  std::uint64_t matching_ = 0;      ///< vertices that only neighbours need
  std::uint64_t for_points_ = 0;    ///< vertices that only points need
  std::uint64_t void_points_ = 0;
  std::uint64_t selected_ = 0;  ///< vertices whose errors are above the tolerance
  std::uint64_t pages_chosen_ = 0, pages_marked_ = 0, pages_gathered_ = 0;
  LargestAbsent absent_;
  using PagesByBand = std::vector<std::unordered_set<std::uint64_t>>;  ///< positions on the curve, by band
  PagesByBand looked_into_ = PagesByBand(static_cast<std::size_t>(pages_.manifest().bands)), marked_ = looked_into_;
};

}  // namespace

// Each region's vertices are closed on the whole grid. Vertices of a shared side have the same ancestors on that side
// in both regions, so two regions agree after one exchange. A third region may share another side, to which the
// closure added vertices. Hence the rounds.
std::vector<Answer> select_and_gather(const StoredPages& pages, std::span<const Question> patches,
                                      std::deque<Watch>& watches) {
  std::vector<std::unique_ptr<Selection>> chosen;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Question& question = patches[i];
    chosen.push_back(std::make_unique<Selection>(pages, question, watches[i]));
    chosen.back()->choose();
    for (const RestrictedQuadtree* neighbour : question.neighbours)
      chosen.back()->match(neighbour->region, neighbour->vertices);
  }
  for (bool is_settled = false; !is_settled;) {
    is_settled = true;
    for (const auto& one : chosen) {
      for (const auto& other : chosen) {
        if (one != other && one->match(other->region(), other->vertices())) is_settled = false;
      }
    }
  }
  std::vector<Answer> answers;
  for (auto& one : chosen) {
    answers.push_back(one->gather());
    one.reset();
  }
  return answers;
}

}  // namespace talus
