#pragma once
// The surface of the answer for the whole extent, at any place, without computing the answer.
//
// Every triangle is half the diamond of its hypotenuse's midpoint. If that vertex is selected, the triangle is split
// from its right angle to the midpoint. So one walks from the root squares down through triangles that contain a place;
// the first whose midpoint is not selected is the answer's.

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/quadtree/extent_border.hpp"
#include "engine/quadtree/grid.hpp"
#include "query/pages/kept_heights.hpp"
#include "query/pages/nearby_pages.hpp"
#include "query/selection/threshold.hpp"

namespace talus {

/// The place of a position. Within 10⁻⁶ cell of a grid line it is on the line, as for rectangles.
[[nodiscard]] Place grid_place(const GridMapping& mapping, Position p);
/// A NaN position lies in no rectangle.
[[nodiscard]] constexpr bool contains(GridRect rect, Place p) {
  return p.col >= rect.first.col && p.col <= rect.last.col && p.row >= rect.first.row && p.row <= rect.last.row;
}

/// The line that splits a triangle, from its right angle to the middle of its hypotenuse: along a row, a column or a
/// diagonal.
struct SplitLine {
  GridPoint from;
  std::int32_t right = 0, down = 0;  ///< its direction, -1, 0 or 1 each

  explicit constexpr SplitLine(const Triangle& t)
      : from(t.apex),
        right(sign(t.left.col + t.right.col - 2 * t.apex.col)),
        down(sign(t.left.row + t.right.row - 2 * t.apex.row)) {}
  /// Positive on one side, negative on the other.
  [[nodiscard]] constexpr double side(Place p) const { return right * (p.row - from.row) - down * (p.col - from.col); }
  [[nodiscard]] constexpr double side(GridPoint p) const { return side(Place{double(p.col), double(p.row)}); }

 private:
  static constexpr std::int32_t sign(std::int32_t v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }
};

/// The plane of a triangle, in height codes.
struct Facet {
  Triangle corners;
  double apex = 0, left = 0, right = 0;
  [[nodiscard]] double at(Place p) const;
};

/// For one thread at a time.
class Surface {
 public:
  /// tolerance  as in Question
  Surface(const StoredPages& pages, const ExtentBorder& border, Metres tolerance, QueryCost& cost);

  /// The triangles at the top: two for each root square that overlaps the extent.
  [[nodiscard]] const std::vector<Triangle>& roots() const { return roots_; }
  /// Whether a triangle overlaps the extent.
  [[nodiscard]] bool may_hold(const Triangle& t) const;
  /// Whether the middle of its hypotenuse is a vertex. The surface then has its two halves.
  [[nodiscard]] bool is_split(const Triangle& t);
  /// The plane of a triangle that is not split; empty if it has no data.
  [[nodiscard]] std::optional<Facet> facet(const Triangle& t);

  /// The height code of a triangle at a place that has data. Places that follow each other on a curve are found from
  /// the triangle before.
  [[nodiscard]] std::optional<double> height(Place p);

  /// The surface's bound in metres. It may be above the tolerance, see RestrictedQuadtree::bound.
  [[nodiscard]] double bound() const;

 private:
  [[nodiscard]] bool is_selected(GridPoint p);
  [[nodiscard]] std::optional<double> height(const Triangle& t, Place p);
  [[nodiscard]] double corner(GridPoint p);
  [[nodiscard]] PageId page_with(GridPoint p) const;

  const StoredPages& pages_;
  const ExtentBorder& border_;
  const Description& description_ = pages_.manifest().description;
  GridRect extent_ = description_.extent;
  double tolerance_;  ///< metres, minus the loss
  Threshold above_{tolerance_, pages_.distance()};
  NearbyPages nearby_;
  std::optional<KeptHeights> kept_heights_;  ///< if some heights were dropped
  std::vector<Triangle> roots_;
  std::vector<Triangle> path_;  ///< the triangles that hold the last place, from the root down
};

}  // namespace talus
