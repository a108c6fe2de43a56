#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "engine/geo/ground.hpp"
#include "engine/geo/longitude.hpp"
#include "engine/machine/fail.hpp"
#include "query/selection/refusals.hpp"
#include "query/surface/heights.hpp"

namespace talus {
namespace {

/// Part of a straight line in one triangle. `from` and `to` are shares of the line, heights are codes.
struct Piece {
  double from = 0, to = 0, height_from = 0, height_to = 0;
  [[nodiscard]] double at(double share) const {
    return to > from ? height_from + (height_to - height_from) * ((share - from) / (to - from)) : height_from;
  }
  [[nodiscard]] Piece part(double first, double last) const { return {first, last, at(first), at(last)}; }
};

/// Pieces in order along a line, without overlap.
using Pieces = std::vector<Piece>;

/// All of `first`, and the parts of `second` in its gaps. A line along an edge lies in both triangles.
Pieces with_gaps_filled(const Pieces& first, const Pieces& second) {
  Pieces all = first;
  auto next = first.begin();
  for (const Piece& piece : second) {
    while (next != first.end() && next->to <= piece.from) ++next;
    double open = piece.from;
    for (auto taken = next; taken != first.end() && taken->from < piece.to; ++taken) {
      if (taken->from > open) all.push_back(piece.part(open, taken->from));
      open = std::max(open, taken->to);
    }
    if (open < piece.to) all.push_back(piece.part(open, piece.to));
  }
  std::sort(all.begin(), all.end(), [](const Piece& a, const Piece& b) { return a.from < b.from; });
  return all;
}

/// Cuts a straight line at the edges of the surface's triangles.
class Cut {
 public:
  Cut(Surface& surface, Place begin, Place end) : surface_(surface), begin_(begin), end_(end) {}

  [[nodiscard]] Pieces run(GridRect extent) {
    Pieces all;
    double from = 0, to = 1;
    clip(begin_.col - extent.first.col, end_.col - extent.first.col, from, to);
    clip(extent.last.col - begin_.col, extent.last.col - end_.col, from, to);
    clip(begin_.row - extent.first.row, end_.row - extent.first.row, from, to);
    clip(extent.last.row - begin_.row, extent.last.row - end_.row, from, to);
    for (const Triangle& root : surface_.roots()) {
      double in = from, out = to;
      const std::array<GridPoint, 3> around{root.apex, root.left, root.right};
      for (std::size_t i = 0; i < 3; ++i) {
        const GridPoint a = around[i], b = around[(i + 1) % 3], within = around[(i + 2) % 3];
        const auto side = [&](Place p) {
          return (b.col - a.col) * (p.row - a.row) - (b.row - a.row) * (p.col - a.col);
        };
        const double sign = side({double(within.col), double(within.row)}) > 0 ? 1 : -1;
        clip(sign * side(begin_), sign * side(end_), in, out);
      }
      if (in < out) all = with_gaps_filled(all, pieces(root, in, out));
    }
    return all;
  }

 private:
  [[nodiscard]] Place at(double share) const {
    // Computed from the nearer end, so that both ends are exact.
    if (share <= 0.5) {
      return {begin_.col + (end_.col - begin_.col) * share, begin_.row + (end_.row - begin_.row) * share};
    }
    const double back = 1 - share;
    return {end_.col + (begin_.col - end_.col) * back, end_.row + (begin_.row - end_.row) * back};
  }

  /// Keeps the part of from..to where a distance, linear along the line, is not negative.
  static void clip(double distance_begin, double distance_end, double& from, double& to) {
    if (distance_begin < 0 && distance_end < 0) {
      to = from;
    } else if (distance_begin < 0) {
      from = std::max(from, distance_begin / (distance_begin - distance_end));
    } else if (distance_end < 0) {
      to = std::min(to, distance_begin / (distance_begin - distance_end));
    }
  }

  /// The pieces of the line from one share to another, within a triangle.
  [[nodiscard]] Pieces pieces(const Triangle& t, double from, double to) {
    Pieces found;
    if (!surface_.may_hold(t)) return found;
    if (!surface_.is_split(t)) {
      if (const std::optional<Facet> facet = surface_.facet(t)) {
        found.push_back({from, to, facet->at(at(from)), facet->at(at(to))});
      }
      return found;
    }
    const SplitLine line(t);
    const double sign = line.side(t.left) > 0 ? 1 : -1;  // positive on the left half's side
    const double begin = sign * line.side(begin_), end = sign * line.side(end_);
    if (begin == 0 && end == 0) {  // along the edge between the halves
      return with_gaps_filled(pieces(left_half(t), from, to), pieces(right_half(t), from, to));
    }
    const double crossing = begin == end ? -1 : begin / (begin - end);
    if (crossing > from && crossing < to) {
      const bool left_first = begin > end;
      found = pieces(left_first ? left_half(t) : right_half(t), from, crossing);
      const Pieces rest = pieces(left_first ? right_half(t) : left_half(t), crossing, to);
      found.insert(found.end(), rest.begin(), rest.end());
      return found;
    }
    const double middle = from + (to - from) / 2;
    return pieces(begin + (end - begin) * middle >= 0 ? left_half(t) : right_half(t), from, to);
  }

  Surface& surface_;
  Place begin_, end_;
};

/// A vertex of the cut, before thinning.
struct CutVertex {
  std::size_t stretch = 0;  ///< the stretch between two of the line's points
  double share = 0;         ///< share of that stretch
  double height = 0;        ///< code
  bool stays = false;
};

/// The surface along the line: parts, with a vertex at each crossed edge.
std::vector<std::vector<CutVertex>> cut(Surface& surface, const Description& d, const Longitudes& longitudes,
                                        std::span<const Position> line) {
  std::vector<std::vector<CutVertex>> parts;
  bool goes_on = false;  // the last part reaches the end of the previous stretch
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    if (line[i] == line[i + 1]) continue;
    // Around the globe, a stretch may begin at one end of the raster and end at the other.
    const std::vector<double> shifts = longitudes.shifts(line[i].x, line[i + 1].x, d.extent);
    const double seam = shifts.size() > 1 ? 1e-12 : 0;
    Pieces pieces;
    for (const double shift : shifts) {
      const auto place = [&](Position p) { return grid_place(d.mapping, {p.x + shift, p.y}); };
      pieces = with_gaps_filled(pieces, Cut(surface, place(line[i]), place(line[i + 1])).run(d.extent));
    }
    double reached = 0;
    for (const Piece& piece : pieces) {
      if (!goes_on || piece.from > reached + seam) {
        if (!parts.empty()) parts.back().back().stays = true;
        parts.emplace_back();
        goes_on = false;
      }
      const bool is_first = parts.back().empty();
      if (is_first || piece.from == 0) {
        // A point between two stretches is one vertex: the beginning of the later one.
        if (!is_first) parts.back().pop_back();
        parts.back().push_back({i, piece.from, piece.height_from, true});
      }
      parts.back().push_back({i, piece.to, piece.height_to, piece.to == 1});
      reached = piece.to;
      goes_on = true;
    }
    goes_on = goes_on && !pieces.empty() && reached == 1;
  }
  if (!parts.empty()) parts.back().back().stays = true;
  return parts;
}

/// Thins a part: leaves out vertices while the straight line past them lies within `slack` of each. A line ends at the
/// last possible vertex before the ranges of allowed slopes have nothing in common. `place` is a vertex's position
/// along its stretch.
template <class Take>
void thin(const std::vector<CutVertex>& part, double slack, Take&& take) {
  take(part.front());
  for (std::size_t anchor = 0; anchor + 1 < part.size();) {
    double lowest = -std::numeric_limits<double>::infinity(), highest = -lowest;
    std::size_t last = anchor + 1;
    // A point between two stretches has share 1 in one and 0 in the next; the latter counts.
    const std::size_t stretch = part[anchor].stretch;
    for (std::size_t i = anchor + 1; i < part.size(); ++i) {
      const double run = (part[i].stretch == stretch ? part[i].share : 1) - part[anchor].share;
      const double rise = part[i].height - part[anchor].height;
      if (rise >= lowest * run && rise <= highest * run) last = i;
      if (part[i].stays) break;
      lowest = std::max(lowest, (rise - slack) / run);
      highest = std::min(highest, (rise + slack) / run);
      if (lowest > highest) break;
    }
    take(part[last]);
    anchor = last;
  }
}

void require_line(std::span<const Position> line) {
  if (line.size() < 2) refuse("a line of {} points: expected two or more", line.size());
  for (const Position p : line) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y))
      refuse("a line through {},{}: expected finite coordinates", p.x, p.y);
  }
  if (std::all_of(line.begin(), line.end(), [&](Position p) { return p == line.front(); }))
    refuse("a line that stays at {},{}: expected two different points", line[0].x, line[0].y);
}

}  // namespace

Profile profile(const StoredPages& pages, const ExtentBorder& border, std::span<const Position> asked,
                Metres tolerance) {
  const auto started = std::chrono::steady_clock::now();
  const Longitudes longitudes = pages.longitudes();
  const std::vector<Position> line = longitudes.short_way(asked);
  require_line(line);
  require_tolerance(tolerance);
  const Description& d = pages.manifest().description;
  Profile result;
  result.tolerance = tolerance;
  result.cost = pages.cost_of_header();

  Surface surface(pages, border, Metres{tolerance.value / 2}, result.cost);
  const double surface_bound = surface.bound();
  // The tolerance minus the surface's bound, or 0.
  double left = 0;
  if (surface_bound < tolerance.value) left = tolerance.value - surface_bound;
  if (std::isinf(tolerance.value)) left = tolerance.value;
  result.bound = Metres{surface_bound + left};
  // Heights at crossed edges are rounded by less than a nanometre, which is taken from the slack.
  constexpr double kRounding = 1e-9;
  const double slack = std::max(0.0, left - kRounding) / pages.distance().metres(1);

  const Ground ground(d.crs);
  std::vector<double> begins{0};  // distances in metres at which stretches begin
  for (std::size_t i = 0; i + 1 < line.size(); ++i) begins.push_back(begins[i] + ground.metres(line[i], line[i + 1]));
  result.length = Metres{begins.back()};

  for (const auto& part : cut(surface, d, longitudes, line)) {
    std::vector<ProfileVertex>& vertices = result.parts.emplace_back();
    thin(part, slack, [&](const CutVertex& v) {
      const Position a = line[v.stretch], b = line[v.stretch + 1];
      const Position p = v.share == 1 ? b : Position{a.x + (b.x - a.x) * v.share, a.y + (b.y - a.y) * v.share};
      vertices.push_back({Metres{begins[v.stretch] + ground.metres(a, p)}, p.x, p.y, d.step.value(v.height)});
    });
  }
  result.cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return result;
}

}  // namespace talus
