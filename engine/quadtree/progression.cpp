#include "talus/progression.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/border.hpp"
#include "engine/quadtree/grid.hpp"

namespace talus {
namespace {

/// log2 of the side of a root square over the window; a larger root needs the same border vertices.
std::size_t root_shift(const RestrictedQuadtree& answer) {
  if (!answer.level_errors.empty()) return answer.level_errors.size() - 1;
  return static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(root_side(answer.vertices.region()))));
}

}  // namespace

Progression::Progression(const RestrictedQuadtree& answer, std::span<const double> errors) {
  if (answer.origin.border != Border::constrain)
    refuse("only an answer with Border::constrain contains coarser answers: ask for one");
  const std::size_t count = answer.vertices.size();
  if (!errors.empty() && errors.size() != count)
    refuse("there are {} errors for {} vertices: expected one a vertex", errors.size(), count);
  const std::size_t root = root_shift(answer);
  const GridRect& window = answer.vertices.region();
  VertexMask forced(window);
  if (window.cols() > 0 && window.rows() > 0) {
    for (const GridPoint p : border_vertices(window, std::int32_t{1} << root)) forced.insert(p);
  }

  std::vector<GridPoint> points(count);
  std::vector<std::uint8_t> step_of(count);
  steps_.resize(root + 1);
  std::uint32_t rank = 0;
  answer.vertices.for_each([&](GridPoint p) {
    const std::size_t shift = std::min<std::size_t>(static_cast<std::size_t>(height_in_tree(p)), root);
    const std::size_t step = forced.contains(p) ? 0 : root - shift;
    points[rank] = p;
    step_of[rank++] = static_cast<std::uint8_t>(step);
    ++steps_[step].end;
  });
  std::size_t begin = 0;
  for (Step& step : steps_) {
    const std::size_t size = step.end;
    step.begin = begin;
    step.end = begin += size;
  }
  ranks_.resize(count);
  std::vector<std::size_t> next(steps_.size());
  for (std::size_t i = 0; i < steps_.size(); ++i) next[i] = steps_[i].begin;
  for (std::uint32_t i = 0; i < count; ++i) ranks_[next[step_of[i]]++] = i;
  if (!errors.empty()) {
    for (const Step& step : steps_) {
      const auto at = [&](std::size_t i) { return ranks_.begin() + static_cast<std::ptrdiff_t>(i); };
      std::stable_sort(at(step.begin), at(step.end), [&](std::uint32_t a, std::uint32_t b) {
        if (errors[a] != errors[b]) return errors[a] > errors[b];
        return is_centre(points[a]) && !is_centre(points[b]);  // the parents of a side midpoint are centres
      });
    }
  }
  points_.resize(count);
  for (std::size_t i = 0; i < count; ++i) points_[i] = points[ranks_[i]];

  // The bound of a step includes the errors of all finer levels, which it leaves out.
  double largest = answer.bound.value;
  for (std::size_t i = steps_.size(); i-- > 0;) {
    const bool is_last = i + 1 == steps_.size();
    if (!is_last) {
      largest = answer.level_errors.empty() ? std::numeric_limits<double>::infinity()
                                            : std::max(largest, answer.level_errors[root - (i + 1)]);
    }
    steps_[i].bound = Metres{largest};
  }
}

std::span<const std::uint32_t> Progression::ranks(std::size_t step) const {
  return std::span(ranks_).subspan(steps_[step].begin, steps_[step].end - steps_[step].begin);
}

std::span<const GridPoint> Progression::points(std::size_t step) const {
  return std::span(points_).subspan(steps_[step].begin, steps_[step].end - steps_[step].begin);
}

RestrictedQuadtree Progression::prefix(const RestrictedQuadtree& answer, std::size_t steps, std::size_t more) const {
  if (steps < 1 || steps > steps_.size() ||
      more > (steps < steps_.size() ? steps_[steps].end - steps_[steps].begin : 0) ||
      answer.heights.size() != ranks_.size())
    refuse("cannot have {} steps and {} more vertices of an answer with {} steps", steps, more, steps_.size());
  const std::size_t end = steps_[steps - 1].end + more;
  const bool is_all = end == ranks_.size();
  RestrictedQuadtree q;
  q.region = answer.region;
  q.tolerance = answer.tolerance;
  q.bound = is_all ? answer.bound : steps_[steps - 1].bound;
  q.origin = answer.origin;
  q.origin.is_plain = answer.origin.is_plain && is_all;
  q.level_errors = answer.level_errors;
  if (more == 0) {
    const std::size_t root = steps_.size() - 1;
    for (std::size_t i = steps; i < steps_.size() && !q.level_errors.empty(); ++i) q.level_errors[root - i] = 0;
  }
  VertexMask vertices(answer.vertices.region());
  for (std::size_t i = 0; i < end; ++i) vertices.insert(points_[i]);
  vertices.seal();
  q.heights.resize(end);
  if (!answer.covers.empty()) q.covers.resize(end, 15);
  for (std::size_t i = 0; i < end; ++i) {
    const std::uint32_t to = vertices.rank(points_[i]);
    q.heights[to] = answer.heights[ranks_[i]];
    if (!answer.covers.empty()) q.covers[to] = answer.covers[ranks_[i]];
  }
  q.vertices = std::move(vertices);
  return q;
}

}  // namespace talus
