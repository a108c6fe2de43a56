// Turns points and lines in CRS coordinates into samples that an answer must have.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/geo/longitude.hpp"
#include "engine/machine/fail.hpp"
#include "talus/quadtree.hpp"

namespace talus {
namespace {

class Nearest {
 public:
  Nearest(const Description& description, GridRect region)
      : mapping_(description.mapping), region_(region), longitudes_(description) {}

  /// The place of a point, at most half a cell outside the region's samples.
  [[nodiscard]] Place place(Position asked) const {
    if (!std::isfinite(asked.x) || !std::isfinite(asked.y))
      refuse("point {}, {}: expected two finite numbers", asked.x, asked.y);
    const Place found = place_at(longitudes_.among(asked, region_));
    const double col = nearest(found.col), row = nearest(found.row);
    if (!(col >= region_.first.col && col <= region_.last.col && row >= region_.first.row && row <= region_.last.row)) {
      refuse("point {}, {}: expected a point in the region, x {} to {}, y {} to {}", asked.x, asked.y,
             mapping_.x(region_.first.col), mapping_.x(region_.last.col), mapping_.y(region_.last.row),
             mapping_.y(region_.first.row));
    }
    return found;
  }

  /// Calls visit(from, to) for the straight parts of a line within the region.
  template <class Visit>
  void parts(std::span<const Position> line, Visit&& visit) const {
    if (line.size() < 2) refuse("line of {} points: expected two or more points", line.size());
    Place from = place(line[0]);
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Place to = place(line[i]);
      part(from, to, visit);
      from = to;
    }
  }

  [[nodiscard]] static GridPoint sample(Place p) {
    return {static_cast<std::int32_t>(nearest(p.col)), static_cast<std::int32_t>(nearest(p.row))};
  }

 private:
  [[nodiscard]] Place place_at(Position p) const {
    return {(p.x - mapping_.x0) / mapping_.dx, (p.y - mapping_.y0) / mapping_.dy};
  }

  /// Goes the short way around the globe. If this leaves the region on one side, it enters again on the other side.
  template <class Visit>
  void part(Place from, Place to, Visit&& visit) const {
    const double turn = longitudes_.turn() / mapping_.dx;  // in cells
    if (turn == 0 || std::abs(to.col - from.col) <= turn / 2) return visit(from, to);
    const double around = to.col > from.col ? -turn : turn;
    const double length = to.col + around - from.col;
    const double edge = around > 0 ? region_.last.col : region_.first.col;
    const double other = around > 0 ? region_.first.col : region_.last.col;
    const auto row_at = [&](double col) {
      return from.row + (to.row - from.row) * std::clamp((col - from.col) / length, 0.0, 1.0);
    };
    visit(from, Place{edge, row_at(edge)});
    visit(Place{other, row_at(other + around)}, to);
  }

  // Halfway between two samples, or within rounding of it, the next one: otherwise a diagonal jumps to and fro.
  static double nearest(double v) { return std::floor(v + (0.5 + 1e-6)); }
  GridMapping mapping_;
  GridRect region_;
  Longitudes longitudes_;
};

/// Samples without duplicates, in the order in which they came. Memory: 8 bytes for each of them. If there are many,
/// also one bit for each sample of the region.
class Samples {
 public:
  explicit Samples(GridRect region) : region_(region), many_(std::max<std::int64_t>(4096, region.samples() / 64)) {}

  void add(GridPoint p) {
    if (!seen_.empty()) {
      if (is_new(p)) samples_.push_back(p);
    } else if (samples_.empty() || samples_.back() != p) {
      samples_.push_back(p);
      if (static_cast<std::int64_t>(samples_.size()) > many_) look_at_all();
    }
  }

  [[nodiscard]] std::vector<GridPoint> take() {
    if (!seen_.empty()) return std::move(samples_);
    std::vector<std::size_t> order(samples_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      const GridPoint p = samples_[a], q = samples_[b];
      return p.row != q.row ? p.row < q.row : p.col < q.col;
    });
    const auto again = std::unique(order.begin(), order.end(),
                                   [&](std::size_t a, std::size_t b) { return samples_[a] == samples_[b]; });
    order.erase(again, order.end());
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < order.size(); ++i) samples_[i] = samples_[order[i]];
    samples_.resize(order.size());
    return std::move(samples_);
  }

 private:
  [[nodiscard]] bool is_new(GridPoint p) {
    const std::int64_t at = std::int64_t{p.row - region_.first.row} * region_.cols() + (p.col - region_.first.col);
    std::uint64_t& word = seen_[static_cast<std::size_t>(at / 64)];
    const std::uint64_t bit = std::uint64_t{1} << (at % 64), before = word;
    word |= bit;
    return (before & bit) == 0;
  }
  void look_at_all() {
    seen_.resize(static_cast<std::size_t>(region_.samples() / 64 + 1));
    std::erase_if(samples_, [&](GridPoint p) { return !is_new(p); });
  }

  GridRect region_;
  std::int64_t many_;
  std::vector<GridPoint> samples_;
  std::vector<std::uint64_t> seen_;  ///< empty while there are few samples
};

/// Adds the ends of a line, and the nearest sample on each column between them, or on each row if it is steep.
void add_part(Place from, Place to, Samples& samples) {
  const double cols = to.col - from.col, rows = to.row - from.row;
  const bool along_cols = std::abs(cols) >= std::abs(rows);
  const double begin = along_cols ? from.col : from.row, length = along_cols ? cols : rows;
  const double direction = length < 0 ? -1 : 1;
  samples.add(Nearest::sample(from));
  for (double at = std::ceil(begin * direction); at <= (begin + length) * direction; ++at) {
    if (length == 0) break;
    const double on_axis = at * direction, t = (on_axis - begin) / length;
    samples.add(
        Nearest::sample(along_cols ? Place{on_axis, from.row + t * rows} : Place{from.col + t * cols, on_axis}));
  }
  samples.add(Nearest::sample(to));
}

}  // namespace

std::vector<GridPoint> samples_nearest(const Description& description, GridRect region,
                                       std::span<const Position> points) {
  const Nearest nearest(description, region);
  std::vector<GridPoint> samples;
  samples.reserve(points.size());
  for (const Position p : points) samples.push_back(Nearest::sample(nearest.place(p)));
  return samples;
}

std::vector<GridPoint> samples_along(const Description& description, GridRect region, std::span<const Position> line) {
  const Nearest nearest(description, region);
  Samples samples(region);
  nearest.parts(line, [&](Place from, Place to) { add_part(from, to, samples); });
  return samples.take();
}

std::vector<GridPoint> samples_along(const Description& description, GridRect region,
                                     std::span<const std::vector<Position>> lines) {
  const Nearest nearest(description, region);
  Samples samples(region);
  for (const std::vector<Position>& line : lines)
    nearest.parts(line, [&](Place from, Place to) { add_part(from, to, samples); });
  return samples.take();
}

}  // namespace talus
