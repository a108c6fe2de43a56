// Errors of the vertices whose triangles are larger than a block.
//
// A slab is a plane through the samples of an 8×8 square and a radius: no sample of the square is farther
// from the plane. Against a triangle's plane a slab bounds, from its four corners, how far any of its
// samples can be. The slab with the highest bound is looked at sample by sample first, then only those whose
// bound exceeds the largest distance so far: the result is exact, most samples are never touched.

#include "engine/slab_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace talus::detail {
namespace {

constexpr int kSlabShift = 3;
constexpr std::int32_t kSlabSide = 1 << kSlabShift;
constexpr double kHalf = (kSlabSide - 1) / 2.0;

struct Slab {
  double middle = 0, right = 0, down = 0;  ///< height at the square's middle, slopes per cell
  double radius = -1;                      ///< negative: no sample that counts
};

template <class Code>
class Slabs {
 public:
  Slabs(const HeightField& field, GridRect square)
      : field_(field), heights_(std::get<std::span<const Code>>(field.heights)), square_(square) {
    const GridRect& e = square;
    first_ = {e.first.col >> kSlabShift, e.first.row >> kSlabShift};
    cols_ = (e.last.col >> kSlabShift) - first_.col + 1;
    rows_ = (e.last.row >> kSlabShift) - first_.row + 1;
    slabs_.resize(static_cast<std::size_t>(cols_) * static_cast<std::size_t>(rows_));
    for (std::int32_t y = 0; y < rows_; ++y) {
      for (std::int32_t x = 0; x < cols_; ++x)
        slab({first_.col + x, first_.row + y}) = fit({first_.col + x, first_.row + y});
    }
  }

  [[nodiscard]] double largest_distance(const HalfDiamond& t) {
    const Plane<double> plane = plane_of(t, [&](GridPoint p) { return field_[p]; });
    candidates_.clear();
    std::size_t best = 0;
    for (std::int32_t y = t.top() >> kSlabShift; y <= t.bottom() >> kSlabShift; ++y) {
      const auto [lo, hi] = columns_of_band(t, y);
      for (std::int32_t x = lo >> kSlabShift; x <= hi >> kSlabShift; ++x) {
        const Slab& s = slab({x, y});
        if (s.radius < 0) continue;
        const double at_middle = plane.base + plane.down * (y * kSlabSide + kHalf - plane.row) +
                                 plane.right * (x * kSlabSide + kHalf - plane.col);
        const double bound = std::abs(s.middle - at_middle) +
                             kHalf * (std::abs(s.right - plane.right) + std::abs(s.down - plane.down)) + s.radius;
        candidates_.push_back({x, y, bound});
        if (bound > candidates_[best].bound) best = candidates_.size() - 1;
      }
    }
    double largest = 0;
    if (!candidates_.empty()) largest = look(t, plane, candidates_[best], largest);
    for (const Candidate& c : candidates_) {
      if (c.bound > largest) largest = look(t, plane, c, largest);
    }
    return largest;
  }

 private:
  struct Candidate {
    std::int32_t x, y;
    double bound;
  };

  Slab& slab(GridPoint at) {
    return slabs_[static_cast<std::size_t>((at.row - first_.row) * cols_ + at.col - first_.col)];
  }

  [[nodiscard]] bool counts(std::size_t sample) const { return field_.is_valid(sample); }
  [[nodiscard]] double height(std::size_t sample) const { return static_cast<double>(heights_[sample]); }

  /// The samples of a slab.
  [[nodiscard]] GridRect square(GridPoint at) const {
    const GridRect& e = square_;
    const std::int32_t col = at.col * kSlabSide, row = at.row * kSlabSide;
    return {{std::max(col, e.first.col), std::max(row, e.first.row)},
            {std::min(col + kSlabSide - 1, e.last.col), std::min(row + kSlabSide - 1, e.last.row)}};
  }

  /// visit(height) for each that counts.
  template <class Visit>
  void for_each_sample(GridRect part, Visit&& visit) const {
    for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
      for (std::int32_t col = part.first.col; col <= part.last.col; ++col) {
        const std::size_t i = field_.index({col, row});
        if (counts(i)) visit(height(i));
      }
    }
  }

  [[nodiscard]] Slab fit(GridPoint at) const {
    const GridRect part = square(at);
    return is_whole(part) ? fit_whole(part.first) : fit_part(part);
  }
  [[nodiscard]] bool is_whole(GridRect part) const {
    if (part.samples() != kSlabSide * kSlabSide) return false;
    int count = 0;
    if (!field_.valid.empty()) for_each_sample(part, [&](double) { ++count; });
    return field_.valid.empty() || count == kSlabSide * kSlabSide;
  }

  /// Least squares, column by column so that the compiler takes several at once.
  [[nodiscard]] Slab fit_whole(GridPoint first) const {
    using Columns = std::array<double, kSlabSide>;
    Columns sums{}, downs{}, largest{}, radii{};
    const Code* start = &heights_[field_.index(first)];
    const std::ptrdiff_t stride = field_.extent.cols();
    for (std::size_t row = 0; row < kSlabSide; ++row) {
      const Code* h = start + static_cast<std::ptrdiff_t>(row) * stride;
      const double weight = static_cast<double>(row) - kHalf;
      for (std::size_t col = 0; col < kSlabSide; ++col) {
        sums[col] += static_cast<double>(h[col]);
        downs[col] += static_cast<double>(h[col]) * weight;
        largest[col] = std::max(largest[col], std::abs(static_cast<double>(h[col])));
      }
    }
    double sum = 0, along = 0, down = 0;
    for (std::size_t col = 0; col < kSlabSide; ++col) {
      sum += sums[col];
      along += sums[col] * (static_cast<double>(col) - kHalf);
      down += downs[col];
    }
    constexpr double kSquares = kSlabSide * (kSlabSide * (kSlabSide * kSlabSide - 1) / 12.0);  // Σ (col − middle)²
    Slab slab{sum / (kSlabSide * kSlabSide), along / kSquares, down / kSquares, 0};
    for (std::size_t row = 0; row < kSlabSide; ++row) {
      const Code* h = start + static_cast<std::ptrdiff_t>(row) * stride;
      const double on_row = slab.middle + slab.down * (static_cast<double>(row) - kHalf);
      for (std::size_t col = 0; col < kSlabSide; ++col) {
        const double on_plane = on_row + slab.right * (static_cast<double>(col) - kHalf);
        radii[col] = std::max(radii[col], std::abs(static_cast<double>(h[col]) - on_plane));
      }
    }
    slab.radius =
        with_rounding(*std::max_element(radii.begin(), radii.end()), *std::max_element(largest.begin(), largest.end()));
    return slab;
  }

  /// A level plane where samples are missing.
  [[nodiscard]] Slab fit_part(GridRect part) const {
    double sum = 0, largest = 0;
    int count = 0;
    for_each_sample(part, [&](double h) {
      sum += h;
      largest = std::max(largest, std::abs(h));
      ++count;
    });
    if (count == 0) return {};
    Slab slab{sum / count, 0, 0, 0};
    for_each_sample(part, [&](double h) { slab.radius = std::max(slab.radius, std::abs(h - slab.middle)); });
    slab.radius = with_rounding(slab.radius, largest);
    return slab;
  }

  /// The bound must hold for the rounding in the fit and in its use, too.
  static double with_rounding(double radius, double largest) { return radius + 1e-12 * (1 + largest); }

  /// Columns the triangle takes on any row of a row of slabs. Its width changes linearly but for one row.
  [[nodiscard]] HalfDiamond::Columns columns_of_band(const HalfDiamond& t, std::int32_t y) const {
    const std::int32_t first = std::max(t.top(), y * kSlabSide);
    const std::int32_t last = std::min(t.bottom(), y * kSlabSide + kSlabSide - 1);
    auto [lo, hi] = t.columns(first);
    for (const std::int32_t row : {last, std::clamp(t.vertex.row, first, last)}) {
      const auto more = t.columns(row);
      lo = std::min(lo, more.lo);
      hi = std::max(hi, more.hi);
    }
    return {lo, hi};
  }

  [[nodiscard]] double look(const HalfDiamond& t, const Plane<double>& plane, const Candidate& c,
                            double largest) const {
    const GridRect part = square({c.x, c.y});
    for (std::int32_t row = std::max(part.first.row, t.top()); row <= std::min(part.last.row, t.bottom()); ++row) {
      const auto [lo, hi] = t.columns(row);
      const double start = plane.on_row(row);
      for (std::int32_t col = std::max(part.first.col, lo); col <= std::min(part.last.col, hi); ++col) {
        const std::size_t i = field_.index({col, row});
        if (!counts(i)) continue;
        largest = std::max(largest, std::abs(height(i) - (start + plane.right * (col - plane.col))));
      }
    }
    return largest;
  }

  const HeightField& field_;
  std::span<const Code> heights_;
  GridRect square_;
  GridPoint first_;
  std::int32_t cols_ = 0, rows_ = 0;
  std::vector<Slab> slabs_;
  std::vector<Candidate> candidates_;
};

}  // namespace

void largest_distances(const HeightField& field, GridRect square, std::span<const HalfDiamond> halves,
                       std::span<double> distances) {
  std::visit(
      [&](auto heights) {
        Slabs<std::remove_const_t<typename decltype(heights)::element_type>> slabs(field, square);
        for (std::size_t i = 0; i < halves.size(); ++i) distances[i] = slabs.largest_distance(halves[i]);
      },
      field.heights);
}

}  // namespace talus::detail
