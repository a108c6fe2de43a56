#pragma once
// A mesh as a function of the place, by looking at every triangle near it: nothing of the hierarchy is used.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "talus/quadtree.hpp"

namespace talus::support {

struct MeshPlace {
  double col = 0, row = 0;
};

class SurfaceOfMesh {
 public:
  explicit SurfaceOfMesh(Mesh mesh) : mesh_(std::move(mesh)) {
    const auto cols = static_cast<std::size_t>(mesh_.region.cols() / kSide + 1);
    const auto rows = static_cast<std::size_t>(mesh_.region.rows() / kSide + 1);
    cols_ = cols;
    squares_.resize(cols * rows);
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto [a, b, c] = corners(t);
      const auto [west, east] = std::minmax({a.col, b.col, c.col});
      const auto [north, south] = std::minmax({a.row, b.row, c.row});
      for (std::size_t y = square(north - mesh_.region.first.row); y <= square(south - mesh_.region.first.row); ++y) {
        for (std::size_t x = square(west - mesh_.region.first.col); x <= square(east - mesh_.region.first.col); ++x) {
          squares_[y * cols_ + x].push_back(t);
        }
      }
    }
  }

  /// Of any closed triangle that contains the place.
  [[nodiscard]] std::optional<double> height(MeshPlace p) const {
    const GridRect& r = mesh_.region;
    if (!(p.col >= r.first.col && p.col <= r.last.col && p.row >= r.first.row && p.row <= r.last.row)) return {};
    const std::size_t at = square(static_cast<std::int32_t>(std::floor(p.row)) - r.first.row) * cols_ +
                           square(static_cast<std::int32_t>(std::floor(p.col)) - r.first.col);
    for (const std::uint32_t t : squares_[at]) {
      const auto [a, b, c] = corners(t);
      const auto cross = [](GridPoint o, GridPoint q, MeshPlace v) {
        return (q.col - o.col) * (v.row - o.row) - (q.row - o.row) * (v.col - o.col);
      };
      const double area = cross(a, b, {double(c.col), double(c.row)});
      const double wa = cross(b, c, p) / area, wb = cross(c, a, p) / area, wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const auto& ids = mesh_.triangles[t];
      return wa * mesh_.heights[ids[0]] + wb * mesh_.heights[ids[1]] + wc * mesh_.heights[ids[2]];
    }
    return std::nullopt;
  }

  /// So near to the outline that rounding decides whether it is on the surface. On a row or column of samples it is
  /// only along that line that it can.
  [[nodiscard]] bool is_doubtful(MeshPlace p, double near = 1e-7) const {
    const bool here = height(p).has_value();
    for (const double down : {-near, 0.0, near}) {
      for (const double right : {-near, 0.0, near}) {
        if ((right != 0 && p.col == std::floor(p.col)) || (down != 0 && p.row == std::floor(p.row))) continue;
        if (height({p.col + right, p.row + down}).has_value() != here) return true;
      }
    }
    return false;
  }

 private:
  static constexpr std::int32_t kSide = 16;
  static std::size_t square(std::int32_t v) { return static_cast<std::size_t>(v / kSide); }

  [[nodiscard]] std::array<GridPoint, 3> corners(std::uint32_t t) const {
    const auto& ids = mesh_.triangles[t];
    return {mesh_.points[ids[0]], mesh_.points[ids[1]], mesh_.points[ids[2]]};
  }

  Mesh mesh_;
  std::size_t cols_ = 0;
  std::vector<std::vector<std::uint32_t>> squares_;
};

}  // namespace talus::support
