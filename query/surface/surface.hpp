#pragma once
// The surface of the answer to the whole extent at a tolerance, wherever one looks at it, without making the answer.
//
// Every triangle is half the diamond of the midpoint of its hypotenuse. Where that vertex is selected, the triangle is
// split into two from its right angle to that midpoint; so from the root squares down any place is reached through
// triangles that contain it, and the first whose midpoint is not selected is the answer's.

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/quadtree/grid.hpp"
#include "query/pages/extent_border.hpp"
#include "query/pages/kept_heights.hpp"
#include "query/pages/nearby_pages.hpp"

namespace talus {

/// Of a position; on a grid line if within 10⁻⁶ cell of it, as rectangles are.
[[nodiscard]] Place grid_place(const GridMapping& mapping, Position p);
/// A position that is no number lies nowhere.
[[nodiscard]] constexpr bool contains(GridRect rect, Place p) {
  return p.col >= rect.first.col && p.col <= rect.last.col && p.row >= rect.first.row && p.row <= rect.last.row;
}

/// The line that splits a triangle, from its right angle to the middle of its hypotenuse. It runs along a row, a column
/// or a diagonal.
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

/// Heights over a triangle, in height codes.
struct Facet {
  Triangle corners;
  double apex = 0, left = 0, right = 0;
  [[nodiscard]] double at(Place p) const;
};

/// Not from several threads at once.
class Surface {
 public:
  /// tolerance  as of Question
  Surface(const StoredPages& pages, const ExtentBorder& border, Metres tolerance, QueryCost& cost);

  /// The triangles to begin with: two for each root square that has something of the extent.
  [[nodiscard]] const std::vector<Triangle>& roots() const { return roots_; }
  /// Whether some of a triangle is within the extent's sides.
  [[nodiscard]] bool may_hold(const Triangle& t) const;
  /// Whether the middle of its hypotenuse is a vertex: then the surface is that of the two halves.
  [[nodiscard]] bool is_split(const Triangle& t);
  /// Of a triangle that is not split; nothing where it holds no data.
  [[nodiscard]] std::optional<Facet> facet(const Triangle& t);

  /// In height codes: of the triangles that are not split and contain a place, any that holds data.
  [[nodiscard]] std::optional<double> height(Place p);

  /// Metres that no covered sample is farther away than; may be above the tolerance asked for, see
  /// RestrictedQuadtree::bound.
  [[nodiscard]] double bound() const;

 private:
  [[nodiscard]] bool is_selected(GridPoint p);
  [[nodiscard]] std::optional<double> height(const Triangle& t, Place p);
  [[nodiscard]] double corner(GridPoint p);
  [[nodiscard]] PageId page_with(GridPoint p) const;

  const StoredPages& pages_;
  const ExtentBorder& border_;
  GridRect extent_;
  double tolerance_;  ///< what is left of the one asked for
  ErrorCode threshold_;
  NearbyPages nearby_;
  std::optional<KeptHeights> kept_heights_;  ///< where some were dropped
  std::vector<Triangle> roots_;
};

}  // namespace talus
