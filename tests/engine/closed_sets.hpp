#pragma once
// Sets of vertices closed under parents, and their triangulation by plain recursion from the root.

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "engine/quadtree/grid.hpp"
#include "tests/engine/fields.hpp"

namespace talus::support {

using Point = std::pair<std::int32_t, std::int32_t>;
inline Point key(GridPoint p) { return {p.col, p.row}; }
inline GridPoint point(Point p) { return {p.first, p.second}; }

inline GridPoint random_point(Random& random, GridRect rect) {
  return {random.between(rect.first.col, rect.last.col), random.between(rect.first.row, rect.last.row)};
}

/// Twice the area of a triangle.
inline std::int64_t area(const Triangle& t) {
  const std::int64_t cross = (std::int64_t{t.left.col} - t.apex.col) * (std::int64_t{t.right.row} - t.apex.row) -
                             (std::int64_t{t.left.row} - t.apex.row) * (std::int64_t{t.right.col} - t.apex.col);
  return cross < 0 ? -cross : cross;
}

/// Vertices below the root corners. All multiples of the root side are there from the start.
class ClosedSet {
 public:
  explicit ClosedSet(std::int32_t root) : root_(root) {}

  void insert(GridPoint p) {
    if (spacing(p) >= root_ || !members_.insert(key(p)).second) return;
    for (const GridPoint parent : diamond(p).apexes) insert(parent);
  }
  [[nodiscard]] bool contains(GridPoint p) const { return spacing(p) >= root_ || members_.contains(key(p)); }
  [[nodiscard]] std::int32_t root() const { return root_; }
  [[nodiscard]] const std::set<Point>& members() const { return members_; }

 private:
  std::int32_t root_;
  std::set<Point> members_;
};

/// The leaves of the hierarchy over the four root squares around the origin: a triangle is split while the
/// midpoint of its hypotenuse is a member.
inline std::vector<Triangle> bisect(const ClosedSet& set) {
  std::vector<Triangle> leaves;
  const auto visit = [&](auto&& self, const Triangle& t) -> void {
    const GridPoint m = midpoint(t.left, t.right);
    if (spacing(t.apex) < 1 || area(t) < 2 || !set.contains(m)) {
      leaves.push_back(t);
      return;
    }
    self(self, {m, t.apex, t.left});
    self(self, {m, t.apex, t.right});
  };
  const std::int32_t r = set.root();
  for (const std::int32_t east : {-r, r}) {
    for (const std::int32_t south : {-r, r}) {
      // The diagonal of a root square runs through the origin.
      visit(visit, {{east, 0}, {0, 0}, {east, south}});
      visit(visit, {{0, south}, {0, 0}, {east, south}});
    }
  }
  return leaves;
}

/// Whether a triangle of the hierarchy and a rectangle share more than a line.
inline bool overlaps(const Triangle& t, GridRect r) {
  // Four points of each unit cell, none on an edge of the hierarchy: one in each quarter its two diagonals cut.
  const auto strictly_inside = [&](std::int64_t col4, std::int64_t row4) {
    const std::array<GridPoint, 3> c{t.apex, t.left, t.right};
    int left = 0, right = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint a = c[i], b = c[(i + 1) % 3];
      const std::int64_t cross = (std::int64_t{b.col} - a.col) * (row4 - 4 * std::int64_t{a.row}) -
                                 (std::int64_t{b.row} - a.row) * (col4 - 4 * std::int64_t{a.col});
      left += cross > 0 ? 1 : 0;
      right += cross < 0 ? 1 : 0;
    }
    return left == 3 || right == 3;
  };
  const std::int32_t c0 = std::max(r.first.col, std::min({t.apex.col, t.left.col, t.right.col}));
  const std::int32_t c1 = std::min(r.last.col, std::max({t.apex.col, t.left.col, t.right.col}));
  const std::int32_t r0 = std::max(r.first.row, std::min({t.apex.row, t.left.row, t.right.row}));
  const std::int32_t r1 = std::min(r.last.row, std::max({t.apex.row, t.left.row, t.right.row}));
  for (std::int32_t row = r0; row < r1; ++row) {
    for (std::int32_t col = c0; col < c1; ++col) {
      for (const auto& [u, v] : {std::pair{2, 1}, {3, 2}, {2, 3}, {1, 2}}) {  // one in each quarter of the cell
        if (strictly_inside(4 * std::int64_t{col} + u, 4 * std::int64_t{row} + v)) return true;
      }
    }
  }
  return false;
}

}  // namespace talus::support
