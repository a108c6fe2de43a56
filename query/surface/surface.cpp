#include "query/surface/surface.hpp"

#include <algorithm>
#include <cmath>

#include "engine/machine/fail.hpp"
#include "query/selection/refusals.hpp"

namespace talus {
namespace {

bool inside(const Triangle& t, GridRect r) { return r.contains(t.apex) && r.contains(t.left) && r.contains(t.right); }

/// Whether a place lies in a triangle and on none of its edges.
bool is_inside(const Triangle& t, Place p) {
  const auto side = [&](GridPoint a, GridPoint b) {
    return (double(b.col) - a.col) * (p.row - a.row) - (double(b.row) - a.row) * (p.col - a.col);
  };
  const double first = side(t.apex, t.left), second = side(t.left, t.right), third = side(t.right, t.apex);
  return (first > 0 && second > 0 && third > 0) || (first < 0 && second < 0 && third < 0);
}

/// The bit of a triangle in RestrictedQuadtree::covers: which of its apex's four triangles it is.
unsigned bit_of(const Triangle& t) {
  const std::array<Triangle, 4> around = apex_triangles(t.apex);
  for (unsigned i = 0; i < around.size(); ++i) {
    if ((around[i].left == t.left && around[i].right == t.right) ||
        (around[i].left == t.right && around[i].right == t.left)) {
      return 1u << i;
    }
  }
  return 0;
}

}  // namespace

Place grid_place(const GridMapping& m, Position p) {
  constexpr double kOnLine = 1e-6;
  const auto on_line = [](double v) {
    const double line = std::nearbyint(v);
    return std::abs(v - line) <= kOnLine ? line : v;
  };
  return {on_line((p.x - m.x0) / m.dx), on_line((p.y - m.y0) / m.dy)};
}

double Facet::at(Place p) const {
  const GridPoint a = corners.apex, l = corners.left, r = corners.right;
  const auto along = [&](GridPoint corner) {
    const double cols = corner.col - a.col, rows = corner.row - a.row;
    return ((p.col - a.col) * cols + (p.row - a.row) * rows) / (cols * cols + rows * rows);
  };
  return apex + along(l) * (left - apex) + along(r) * (right - apex);  // the legs are at right angles
}

Surface::Surface(const StoredPages& pages, const ExtentBorder& border, Metres tolerance, QueryCost& cost)
    : pages_(pages),
      border_(border),
      tolerance_(std::max(description_.kept_above().value, tolerance.value - description_.lossy.value)),
      nearby_(pages, cost) {
  require_tolerance(tolerance);
  if (description_.kept_above().value > 0) kept_heights_.emplace(pages, cost);
  if (extent_.cols() < 2 || extent_.rows() < 2) return;  // no area, no triangle
  for_each_root_triangle(extent_, [&](const Triangle& root) {
    if (may_hold(root)) roots_.push_back(root);
  });
}

bool Surface::may_hold(const Triangle& t) const {
  const auto [west, east] = std::minmax({t.apex.col, t.left.col, t.right.col});
  const auto [north, south] = std::minmax({t.apex.row, t.left.row, t.right.row});
  return west < extent_.last.col && east > extent_.first.col && north < extent_.last.row && south > extent_.first.row;
}

PageId Surface::page_with(GridPoint p) const { return page_of(p, band_of(p, pages_.manifest().bands)); }

bool Surface::is_split(const Triangle& t) {
  if (is_finest(t)) return false;
  // The border splits every triangle that leaves the extent.
  return !inside(t, extent_) || is_selected(midpoint(t.left, t.right));
}

bool Surface::is_selected(GridPoint p) {
  const PageId id = page_with(p);
  const ChildEntry& entry = nearby_.entry(id);
  // A vertex beside voids may belong to a page without data, which is not stored. No triangle with data needs it.
  if (!entry.present) return false;
  if (!above_(entry.largest) && !border_.contains(p)) return false;  // without reading the page
  const Page& page = *nearby_.page(id);
  return above_(page, page.index(p)) || border_.contains(p);
}

std::optional<Facet> Surface::facet(const Triangle& t) {
  if (!inside(t, extent_)) return std::nullopt;
  const Page* page = nearby_.page(page_with(t.apex));
  if (page == nullptr) return std::nullopt;
  if (!page->covers.empty() && (page->covers[page->index(t.apex)] & bit_of(t)) == 0) return std::nullopt;
  return Facet{t, corner(t.apex), corner(t.left), corner(t.right)};
}

double Surface::corner(GridPoint p) {
  const PageId id = page_with(p);
  const Page* page = nearby_.page(id);
  if (page == nullptr) {
    fail_in(pages_.file(), Cause::corrupt, "corrupt: {}: page {}/{} of band {} is missing, but a triangle needs it",
            pages_.file().string(), id.x, id.y, id.band);
  }
  const std::size_t i = page->index(p);
  return kept_heights_ && !kept_heights_->is_kept(*page, i, p) ? kept_heights_->at(p) : page->height(i);
}

std::optional<double> Surface::height(Place p) {
  if (!contains(extent_, p)) return std::nullopt;
  // A place inside a triangle of the last path, not on its edges, is in no other triangle of that size.
  while (!path_.empty() && !is_inside(path_.back(), p)) path_.pop_back();
  if (!path_.empty()) {
    const Triangle from = path_.back();
    path_.pop_back();
    return height(from, p);
  }
  for (const Triangle& root : roots_) {
    const double half = 0.5 * root_side(extent_);
    const GridPoint middle = midpoint(root.left, root.right);
    if (std::abs(p.col - middle.col) > half || std::abs(p.row - middle.row) > half) continue;
    // A root square is cut along its diagonal. A place belongs to the half on its side.
    const std::int64_t right = root.right.col - root.left.col, down = root.right.row - root.left.row;
    const auto side = [&](double col, double row) {
      return static_cast<double>(right) * (row - root.left.row) - static_cast<double>(down) * (col - root.left.col);
    };
    if (side(p.col, p.row) * side(root.apex.col, root.apex.row) < 0) continue;
    path_.clear();
    if (const auto found = height(root, p)) return found;
  }
  return std::nullopt;
}

std::optional<double> Surface::height(const Triangle& top, Place p) {
  Triangle t = top;
  for (;;) {
    path_.push_back(t);
    if (!is_split(t)) break;
    const SplitLine line(t);
    const double side = line.side(p);
    const Triangle left = left_half(t), right = right_half(t);
    if (side == 0) {  // on both: one may be void or beyond the extent
      if (may_hold(left)) {
        if (const auto found = height(left, p)) return found;
      }
      t = right;
    } else {
      t = side * line.side(t.left) > 0 ? left : right;
    }
    if (!may_hold(t)) return std::nullopt;
  }
  const std::optional<Facet> found = facet(t);
  return found ? std::optional(found->at(p)) : std::nullopt;
}

double Surface::bound() const {
  // An answer's bound may be smaller: it is the largest error of an absent vertex.
  const Description& d = description_;
  constexpr double kDecimalRounding = 1e-9;
  const bool heights_are_exact = pages_.distance().is_binary() && d.step.offset == 0 && d.finest_tolerance.value == 0;
  return tolerance_ + d.lossy.value + (heights_are_exact ? 0 : kDecimalRounding);
}

}  // namespace talus
