#pragma once
// One half of a diamond: the right triangle in the mesh while its vertex is absent, its rows, and its plane.

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "engine/quadtree/grid.hpp"

namespace talus {

struct HalfDiamond {
  GridPoint vertex;     ///< the absent vertex, midpoint of the hypotenuse
  GridPoint apex;       ///< the right angle
  GridPoint a, b;       ///< ends of the hypotenuse
  std::int32_t s = 0;   ///< spacing of `vertex`
  bool centre = false;  ///< the legs run along the axes; false: the hypotenuse does

  struct Columns {
    std::int32_t lo, hi;
  };

  [[nodiscard]] std::int32_t top() const { return std::min({apex.row, a.row, b.row}); }
  [[nodiscard]] std::int32_t bottom() const { return std::max({apex.row, a.row, b.row}); }

  /// First and last column of the closed triangle on a row from top() to bottom().
  [[nodiscard]] Columns columns(std::int32_t row) const {
    if (centre) {
      const std::int32_t reach = 2 * s - std::abs(row - apex.row);
      return vertex.col > apex.col ? Columns{apex.col, apex.col + reach} : Columns{apex.col - reach, apex.col};
    }
    const std::int32_t from_vertex = std::abs(row - vertex.row);
    if (a.row == b.row) return {vertex.col - (s - from_vertex), vertex.col + (s - from_vertex)};
    const std::int32_t reach = s - from_vertex;
    return apex.col > vertex.col ? Columns{vertex.col, vertex.col + reach} : Columns{vertex.col - reach, vertex.col};
  }
  /// Columns of the triangle on these rows, or more: its width changes linearly except at the vertex's row.
  [[nodiscard]] Columns columns_over(std::int32_t first_row, std::int32_t last_row) const {
    auto [lo, hi] = columns(first_row);
    for (const std::int32_t row : {last_row, std::clamp(vertex.row, first_row, last_row)}) {
      const Columns more = columns(row);
      lo = std::min(lo, more.lo);
      hi = std::max(hi, more.hi);
    }
    return {lo, hi};
  }
};

[[nodiscard]] inline HalfDiamond half_diamond(GridPoint vertex, int side) {
  const Diamond d = diamond(vertex);
  return {vertex, d.apexes[static_cast<std::size_t>(side)], d.ends[0], d.ends[1], spacing(vertex), is_centre(vertex)};
}

[[nodiscard]] constexpr bool inside(const HalfDiamond& t, GridRect r) {
  return r.contains(t.apex) && r.contains(t.a) && r.contains(t.b);
}

/// The plane through the three corners. Talus always evaluates it in this order of operations (base + down·Δrow, then
/// + right·Δcol, divisions by powers of two only), so that all kernels agree bit for bit, also for fractional heights.
template <class Real>
struct Plane {
  std::int32_t col = 0, row = 0;  ///< position of `base`
  Real base{}, right{}, down{};

  [[nodiscard]] Real on_row(std::int32_t r) const { return base + down * static_cast<double>(r - row); }
};

/// at(GridPoint) is the height of a corner.
template <class At>
[[nodiscard]] Plane<double> plane_of(const HalfDiamond& t, At&& at) {
  if (t.centre) {
    const bool a_on_row = t.a.row == t.apex.row;
    const GridPoint along = a_on_row ? t.a : t.b, across = a_on_row ? t.b : t.a;
    const double h = at(t.apex);
    return {t.apex.col, t.apex.row, h, (at(along) - h) / (along.col - t.apex.col),
            (at(across) - h) / (across.row - t.apex.row)};
  }
  const double ha = at(t.a), hb = at(t.b), mid = (ha + hb) / 2;
  const double along = (hb - ha) / (2 * t.s);
  if (t.a.row == t.b.row) {
    return {t.vertex.col, t.vertex.row, mid, along, (at(t.apex) - mid) / (t.apex.row - t.vertex.row)};
  }
  return {t.vertex.col, t.vertex.row, mid, (at(t.apex) - mid) / (t.apex.col - t.vertex.col), along};
}

}  // namespace talus
