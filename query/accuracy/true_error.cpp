#include "query/accuracy/true_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace talus {
namespace {

constexpr std::int64_t kStripSamples = std::int64_t{1} << 21;
constexpr std::int64_t kLeastStripRows = 16;

// A closed triangle over grid points. A point is in it if all three weights are >= 0. A weight is twice the area that
// the point makes with a side; the weights add up to twice the triangle's area.
class JudgedTriangle {
 public:
  JudgedTriangle(const Mesh& mesh, const std::array<std::uint32_t, 3>& ids) {
    for (std::size_t i = 0; i < 3; ++i) {
      corner_[i] = mesh.points[ids[i]];
      height_[i] = mesh.heights[ids[i]];
    }
    if (cross(corner_[0], corner_[1], corner_[2]) < 0) {
      std::swap(corner_[1], corner_[2]);
      std::swap(height_[1], height_[2]);
    }
    area_ = cross(corner_[0], corner_[1], corner_[2]);
    const auto [top, bottom] = std::minmax({corner_[0].row, corner_[1].row, corner_[2].row});
    first_row_ = top;
    last_row_ = bottom;
  }

  [[nodiscard]] std::int32_t first_row() const { return first_row_; }
  [[nodiscard]] std::int32_t last_row() const { return last_row_; }

  // The row of the middle of the longest side, measured in columns and rows.
  [[nodiscard]] std::int32_t middle_row() const {
    std::int64_t longest = -1;
    std::int32_t row = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint a = corner_[i], b = corner_[(i + 1) % 3];
      const std::int64_t dc = std::int64_t{a.col} - b.col, dr = std::int64_t{a.row} - b.row;
      if (dc * dc + dr * dr > longest) longest = dc * dc + dr * dr, row = (a.row + b.row) / 2;
    }
    return row;
  }

  // The cosine of the angle between the surface and the horizontal: z per metre of the plane's normal.
  [[nodiscard]] double cosine(double metres_per_unit, std::array<double, 2> cell) const {
    const auto edge = [&](std::size_t i) {
      return std::array<long double, 3>{(static_cast<long double>(corner_[i].col) - corner_[0].col) * cell[0],
                                        (static_cast<long double>(corner_[i].row) - corner_[0].row) * cell[1],
                                        (static_cast<long double>(height_[i]) - height_[0]) * metres_per_unit};
    };
    const auto u = edge(1), v = edge(2);
    const long double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    const long double length = std::sqrt(x * x + y * y + z * z);
    return length > 0 ? static_cast<double>(std::abs(z) / length) : 1;
  }

  // Calls visit(col, height of the surface) for the grid points of a row in the triangle.
  template <class Visit>
  void for_row(std::int32_t row, Visit&& visit) const {
    if (area_ == 0) return;                         // contains no sample
    std::array<std::int64_t, 3> weight{}, slope{};  // at column 0, and per column
    std::int64_t first = std::min({corner_[0].col, corner_[1].col, corner_[2].col});
    std::int64_t last = std::max({corner_[0].col, corner_[1].col, corner_[2].col});
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint a = corner_[(i + 1) % 3], b = corner_[(i + 2) % 3];
      weight[i] = cross(a, b, {0, row});
      slope[i] = std::int64_t{a.row} - b.row;
      if (slope[i] > 0) {
        first = std::max(first, -floor_div(weight[i], slope[i]));
      } else if (slope[i] < 0) {
        last = std::min(last, floor_div(weight[i], -slope[i]));
      } else if (weight[i] < 0) {
        return;
      }
    }
    // Long double is far more exact than heights, so a difference is the mesh's fault.
    const long double rise1 = static_cast<long double>(height_[1]) - height_[0];
    const long double rise2 = static_cast<long double>(height_[2]) - height_[0];
    for (std::int64_t col = first; col <= last; ++col) {
      const auto w1 = static_cast<long double>(weight[1] + slope[1] * col);
      const auto w2 = static_cast<long double>(weight[2] + slope[2] * col);
      visit(static_cast<std::int32_t>(col), height_[0] + (w1 * rise1 + w2 * rise2) / static_cast<long double>(area_));
    }
  }

 private:
  static std::int64_t cross(GridPoint a, GridPoint b, GridPoint p) {
    return (std::int64_t{b.col} - a.col) * (std::int64_t{p.row} - a.row) -
           (std::int64_t{b.row} - a.row) * (std::int64_t{p.col} - a.col);
  }
  static std::int64_t floor_div(std::int64_t n, std::int64_t d) { return n / d - (n % d < 0 ? 1 : 0); }  // d > 0

  std::array<GridPoint, 3> corner_{};
  std::array<double, 3> height_{};
  std::int64_t area_ = 0;
  std::int32_t first_row_ = 0, last_row_ = 0;
};

// 1 for each sample that is a corner of a valid finest triangle.
std::vector<std::uint8_t> covered_samples(const SampleWindow& window) {
  std::vector<std::uint8_t> covered(window.valid.size(), 0);
  const GridRect& r = window.region;
  for (std::int32_t row = r.first.row; row < r.last.row; ++row) {
    std::size_t nw = window.index({r.first.col, row});
    std::size_t sw = window.index({r.first.col, row + 1});
    for (std::int32_t col = r.first.col; col < r.last.col; ++col, ++nw, ++sw) {
      const bool falling = ((col ^ row) & 1) == 0;  // the cut runs from north-west to south-east
      const std::array<std::size_t, 2> cut = falling ? std::array{nw, sw + 1} : std::array{nw + 1, sw};
      const std::array<std::size_t, 2> rest = falling ? std::array{nw + 1, sw} : std::array{nw, sw + 1};
      if (!window.valid[cut[0]] || !window.valid[cut[1]]) continue;
      for (const std::size_t apex : rest) {
        if (window.valid[apex]) covered[apex] = covered[cut[0]] = covered[cut[1]] = 1;
      }
    }
  }
  return covered;
}

// Indices of triangles, sorted by their northernmost row.
std::vector<std::uint32_t> from_north_to_south(const Mesh& mesh) {
  const auto bucket = [&](std::size_t t) {
    const std::int32_t row = JudgedTriangle(mesh, mesh.triangles[t]).first_row();
    return static_cast<std::size_t>(std::clamp(row, mesh.region.first.row, mesh.region.last.row) -
                                    mesh.region.first.row);
  };
  std::vector<std::uint32_t> next(static_cast<std::size_t>(mesh.region.rows()) + 1, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) ++next[bucket(t) + 1];
  for (std::size_t r = 1; r < next.size(); ++r) next[r] += next[r - 1];
  std::vector<std::uint32_t> order(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) order[next[bucket(t)]++] = static_cast<std::uint32_t>(t);
  return order;
}

}  // namespace

TrueError true_error(const Mesh& mesh, const Description& description, const SampleReader& truth,
                     const ErrorVisitor& visit, const CellsOfRow& cells) {
  TrueError result;
  const GridRect& region = mesh.region;
  if (region.cols() < 1 || region.rows() < 1) return result;

  const std::vector<std::uint32_t> order = from_north_to_south(mesh);
  const std::int64_t strip_rows = std::max(kLeastStripRows, kStripSamples / region.cols());
  std::vector<std::uint32_t> reaching;  // triangles from earlier strips that reach into this one
  std::size_t next = 0;

  for (std::int64_t top = region.first.row; top <= region.last.row; top += strip_rows) {
    const auto first = static_cast<std::int32_t>(top);
    const auto last = static_cast<std::int32_t>(std::min<std::int64_t>(top + strip_rows - 1, region.last.row));
    // One more row on both sides, because a finest triangle in the next strip may cover a sample.
    const SampleWindow window = truth({{region.first.col, std::max(first - 1, region.first.row)},
                                       {region.last.col, std::min(last + 1, region.last.row)}});
    const std::vector<std::uint8_t> covered = covered_samples(window);
    constexpr double kUntouched = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> farthest(covered.size(), kUntouched);  // surface minus sample, in metres

    while (next < order.size() && JudgedTriangle(mesh, mesh.triangles[order[next]]).first_row() <= last) {
      reaching.push_back(order[next++]);
    }
    std::size_t kept = 0;
    for (const std::uint32_t id : reaching) {
      const JudgedTriangle facet{mesh, mesh.triangles[id]};
      const double cosine = cells ? facet.cosine(description.metres_per_unit, cells(facet.middle_row())) : 0;
      for (std::int32_t row = std::max(first, facet.first_row()); row <= std::min(last, facet.last_row()); ++row) {
        const std::size_t start = window.index({region.first.col, row});
        facet.for_row(row, [&](std::int32_t col, long double surface) {
          if (col < region.first.col || col > region.last.col) return;
          const std::size_t at = start + static_cast<std::size_t>(std::int64_t{col} - region.first.col);
          if (!window.valid[at]) return;
          auto error = static_cast<double>((surface - window.values[at]) * description.metres_per_unit);
          if (std::isnan(error)) error = std::numeric_limits<double>::infinity();  // the largest possible error
          if (!(std::abs(error) <= std::abs(farthest[at]))) farthest[at] = error;
          if (cells)
            result.largest_perpendicular_m = std::max(result.largest_perpendicular_m, std::abs(error) * cosine);
        });
      }
      if (facet.last_row() > last) reaching[kept++] = id;
    }
    reaching.resize(kept);

    std::size_t i = window.index({region.first.col, first});
    for (std::int32_t row = first; row <= last; ++row) {
      for (std::int64_t col = region.first.col; col <= region.last.col; ++col, ++i) {
        const bool touched = !std::isnan(farthest[i]);
        result.covered += covered[i];
        result.uncovered += covered[i] != 0 && !touched;
        result.stray += window.valid[i] != 0 && covered[i] == 0 && !touched;
        if (!touched) continue;
        result.errors.add(std::abs(farthest[i]));
        if (visit) visit({static_cast<std::int32_t>(col), row}, farthest[i]);
      }
    }
  }
  result.largest_m = result.errors.largest();
  return result;
}

}  // namespace talus
