// Errors of vertices whose triangles are larger than a block.
//
// The shape of a block is a plane near its samples and, for each slab of 8×8 samples, the range of their distances from
// the plane. From a shape follows an upper bound of the distance of any sample from a triangle's plane: first for the
// block, then for each slab. The block with the highest bound is searched first, then only blocks, slabs and samples
// whose bound exceeds the largest distance so far. The result is exact, and most samples are never read.

#include "engine/error/slab_errors.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/error/kernel_choice.hpp"
#include "engine/quadtree/rect.hpp"

namespace talus::detail {
namespace {

constexpr int kSlabShift = 3;
static_assert(1 << kSlabShift == kSlabCells);

template <class Code>
const ShapeKernel& kernel_of(const BlockKernel& kernel) {
  if constexpr (std::is_same_v<Code, std::int16_t>) return kernel.whole_shape;
  if constexpr (std::is_same_v<Code, float>) return kernel.floats_shape;
  return kernel.doubles_shape;
}

/// The largest number of a type that is not above a height.
template <class Code>
double rounded_down(double height) {
  if constexpr (std::is_same_v<Code, std::int16_t>) return std::floor(height);
  const auto c = static_cast<Code>(height);
  const bool is_above = static_cast<double>(c) > height;
  return static_cast<double>(is_above ? std::nextafter(c, static_cast<Code>(-std::numeric_limits<float>::max())) : c);
}

template <class Code>
class Shapes {
 public:
  explicit Shapes(const HeightField& field)
      : field_(field),
        heights_(std::get<std::span<const Code>>(field.heights)),
        kernel_(kernel_of<Code>(block_kernel())) {}

  [[nodiscard]] BlockShape shape(GridPoint corner) {
    BlockShape shape;
    const GridRect own = square(corner, kBlockSide), part = common(own, field_.extent);
    if (is_empty(part)) return shape;
    const OwnSamples samples = part == own ? in_place(corner) : copied(corner, part);
    const HeightRange range = kernel_.range(samples);
    shape.has_data = range.lowest <= range.highest;
    if (!shape.has_data) return shape;
    shape.typical = typical(samples, range);
    fit(samples, range, shape);
    bound(samples, range, shape);
    return shape;
  }

 private:
  [[nodiscard]] OwnSamples in_place(GridPoint corner) const {
    const std::size_t at = field_.index(corner);
    const std::ptrdiff_t stride = field_.extent.cols();
    return {&heights_[at], stride, has_void(at, stride) ? &field_.valid[at] : nullptr, stride};
  }
  [[nodiscard]] bool has_void(std::size_t at, std::ptrdiff_t stride) const {
    if (field_.valid.empty()) return false;
    for (int row = 0; row < kBlockSide; ++row) {
      if (std::memchr(&field_.valid[at + static_cast<std::size_t>(row * stride)], 0, kBlockSide) != nullptr)
        return true;
    }
    return false;
  }
  [[nodiscard]] OwnSamples copied(GridPoint corner, GridRect part) {
    valid_.fill(0);
    codes_.fill(Code{});
    for_each_point(part, [&](GridPoint p) {
      const std::size_t to = index_in(square(corner, kBlockSide), p), from = field_.index(p);
      codes_[to] = heights_[from];
      valid_[to] = field_.is_valid(from) ? 1 : 0;
    });
    return {codes_.data(), kBlockSide, valid_.data(), kBlockSide};
  }

  [[nodiscard]] double typical(const OwnSamples& samples, HeightRange range) const {
    const double middle = range.lowest + (range.highest - range.lowest) / 2;
    const HeightRange near = kernel_.around(samples, rounded_down<Code>(middle));
    return range.highest > middle && near.highest - middle < middle - near.lowest ? near.highest : near.lowest;
  }

  /// Planes are stored in records. Bits that hardly change a bound would take bytes.
  static constexpr std::uint32_t kSpareBits = 0xff;
  static float shorter(float v) { return std::bit_cast<float>(std::bit_cast<std::uint32_t>(v) & ~kSpareBits); }
  /// v is at least 0.
  static float shorter_and_no_less(float v) {
    return shorter(std::bit_cast<float>(std::bit_cast<std::uint32_t>(v) + kSpareBits));
  }

  /// A least-squares fit to every 8th sample of every 8th row.
  static void fit(const OwnSamples& samples, HeightRange range, BlockShape& shape) {
    double n = 0, x = 0, y = 0, h = 0, xx = 0, xy = 0, yy = 0, xh = 0, yh = 0;
    const double base = range.lowest + (range.highest - range.lowest) / 2;
    for (int row = kSlabCells / 2; row < kBlockSide; row += kSlabCells) {
      for (int col = kSlabCells / 2; col < kBlockSide; col += kSlabCells) {
        if (samples.valid != nullptr && samples.valid[row * samples.valid_stride + col] == 0) continue;
        const double u = col - kBlockSide / 2, v = row - kBlockSide / 2;
        const double height =
            static_cast<double>(static_cast<const Code*>(samples.heights)[row * samples.stride + col]) - base;
        n += 1, x += u, y += v, h += height;
        xx += u * u, xy += u * v, yy += v * v, xh += u * height, yh += v * height;
      }
    }
    double right = 0, down = 0, middle = base;
    if (n > 0) {
      const double a = xx - x * x / n, b = xy - x * y / n, c = yy - y * y / n, p = xh - x * h / n, q = yh - y * h / n;
      const double determinant = a * c - b * b;
      if (determinant > 1e-3 * (a * c + 1)) {
        right = (p * c - q * b) / determinant;
        down = (q * a - p * b) / determinant;
      }
      middle += (h - right * x - down * y) / n;
    }
    shape.middle = static_cast<float>(middle);
    shape.right = shorter(static_cast<float>(right));
    shape.down = shorter(static_cast<float>(down));
  }

  void bound(const OwnSamples& samples, HeightRange range, BlockShape& shape) const {
    constexpr float kHalf = kBlockSide / 2;
    const float plane[3] = {shape.middle - kHalf * shape.right - kHalf * shape.down, shape.right, shape.down};
    kernel_.slabs(samples, plane, shape.slabs);
    // A few float roundings, each at most 2⁻²⁴ of the number.
    const double largest =
        std::max(std::abs(range.lowest), std::abs(range.highest)) + std::abs(static_cast<double>(shape.middle)) +
        kBlockSide * (std::abs(static_cast<double>(shape.right)) + std::abs(static_cast<double>(shape.down)));
    const auto rounding = static_cast<float>(largest * 0x1p-20 + 1e-30);
    float below = 0, above = 0;
    for (std::size_t i = 0; i < kSlabsAcross * kSlabsAcross; ++i) {
      if (!(shape.slabs.low[i] <= shape.slabs.high[i])) continue;
      shape.slabs.low[i] -= rounding;
      shape.slabs.high[i] += rounding;
      below = std::max(below, -shape.slabs.low[i]);
      above = std::max(above, shape.slabs.high[i]);
    }
    shape.above = shorter_and_no_less(above);
    shape.below = shorter_and_no_less(below);
  }

  const HeightField& field_;
  std::span<const Code> heights_;
  const ShapeKernel& kernel_;
  std::array<Code, kBlockSide * kBlockSide> codes_;
  std::array<std::uint8_t, kBlockSide * kBlockSide> valid_;
};

// ---- triangles ----------------------------------------------------------------------------------------

template <class Code>
class Distances {
 public:
  Distances(const HeightField& field, std::span<const BlockShape> shapes, GridRect blocks)
      : field_(field), heights_(std::get<std::span<const Code>>(field.heights)), shapes_(shapes), blocks_(blocks) {}

  [[nodiscard]] double largest(const HalfDiamond& t) {
    plane_ = plane_of(t, [&](GridPoint p) { return field_[p]; });
    candidates_.clear();
    for_each_square(t, kBlockShift,
                    {{blocks_.first.col * kBlockSide, blocks_.first.row * kBlockSide},
                     {(blocks_.last.col + 1) * kBlockSide - 1, (blocks_.last.row + 1) * kBlockSide - 1}},
                    [&](GridPoint block) {
                      const BlockShape& shape = shape_of(block);
                      if (!shape.has_data) return;
                      candidates_.push_back({block, bound_of(block, shape)});
                    });
    double largest = 0;
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& one, const Candidate& other) { return one.bound > other.bound; });
    for (const Candidate& c : candidates_) {
      if (c.bound <= largest) break;
      look_at_block(t, c.block, largest);
    }
    return largest;
  }

 private:
  struct Candidate {
    GridPoint block;
    double bound;
  };
  /// The difference between a block's plane and the triangle's.
  struct Gap {
    double at_centre, right, down;
  };

  [[nodiscard]] const BlockShape& shape_of(GridPoint block) const { return shapes_[index_in(blocks_, block)]; }
  [[nodiscard]] Gap gap_of(GridPoint block, const BlockShape& shape) const {
    const std::int32_t col = block.col * kBlockSide + kBlockSide / 2, row = block.row * kBlockSide + kBlockSide / 2;
    const double on_triangle = plane_.base + plane_.down * (row - plane_.row) + plane_.right * (col - plane_.col);
    return {static_cast<double>(shape.middle) - on_triangle, static_cast<double>(shape.right) - plane_.right,
            static_cast<double>(shape.down) - plane_.down};
  }
  /// Adds the rounding of the bound itself.
  [[nodiscard]] static double with_rounding(double bound, const Gap& gap) {
    return bound + 1e-12 * (1 + std::abs(gap.at_centre) + bound);
  }
  [[nodiscard]] double bound_of(GridPoint block, const BlockShape& shape) const {
    const Gap gap = gap_of(block, shape);
    const double tilt = kBlockSide / 2 * (std::abs(gap.right) + std::abs(gap.down));
    return with_rounding(tilt + std::max(gap.at_centre + static_cast<double>(shape.above),
                                         static_cast<double>(shape.below) - gap.at_centre),
                         gap);
  }

  void look_at_block(const HalfDiamond& t, GridPoint block, double& largest) {
    const BlockShape& shape = shape_of(block);
    const Gap gap = gap_of(block, shape);
    const GridPoint corner{block.col * kBlockSide, block.row * kBlockSide};
    constexpr double kHalf = (kSlabCells - 1) / 2.0;
    const double tilt = kHalf * (std::abs(gap.right) + std::abs(gap.down));
    const double first = gap.at_centre + (gap.right + gap.down) * (kHalf - kBlockSide / 2);
    // In floats: a few roundings, each at most 2⁻²⁴ of the number.
    const double spread = std::abs(gap.at_centre) + kBlockSide * (std::abs(gap.right) + std::abs(gap.down)) +
                          static_cast<double>(shape.above) + static_cast<double>(shape.below);
    std::array<float, kSlabsAcross * kSlabsAcross> bounds;
    kernel_.bounds(shape.slabs, static_cast<float>(first), static_cast<float>(gap.right * kSlabCells),
                   static_cast<float>(gap.down * kSlabCells), static_cast<float>(tilt + spread * 0x1p-20 + 1e-30),
                   bounds.data());
    // Slabs with samples of the triangle only; the highest bound first.
    std::array<std::size_t, kSlabsAcross * kSlabsAcross> inside;
    std::size_t count = 0, best = 0;
    const GridRect own{corner, {corner.col + kBlockSide - 1, corner.row + kBlockSide - 1}};
    for_each_square(t, kSlabShift, own, [&](GridPoint slab) {
      const std::int32_t x = slab.col - (corner.col >> kSlabShift), y = slab.row - (corner.row >> kSlabShift);
      const auto i = static_cast<std::size_t>(y * kSlabsAcross + x);
      if (static_cast<double>(bounds[i]) <= largest) return;
      if (count == 0 || bounds[i] > bounds[inside[best]]) best = count;
      inside[count++] = i;
    });
    if (count == 0) return;
    look_at_slab(t, slab_at(corner, inside[best]), largest);
    for (std::size_t k = 0; k < count; ++k) {
      if (static_cast<double>(bounds[inside[k]]) > largest) look_at_slab(t, slab_at(corner, inside[k]), largest);
    }
  }
  [[nodiscard]] static GridPoint slab_at(GridPoint corner, std::size_t i) {
    const auto n = static_cast<std::int32_t>(i);
    return {corner.col + n % kSlabsAcross * kSlabCells, corner.row + n / kSlabsAcross * kSlabCells};
  }

  void look_at_slab(const HalfDiamond& t, GridPoint first, double& largest) const {
    std::array<double, kSlabCells> farthest{};
    const std::int32_t last_row = std::min({first.row + kSlabCells - 1, field_.extent.last.row, t.bottom()});
    for (std::int32_t row = std::max({first.row, field_.extent.first.row, t.top()}); row <= last_row; ++row) {
      const auto [lo, hi] = t.columns(row);
      const double start = plane_.on_row(row);
      const std::int32_t from = std::max({first.col, field_.extent.first.col, lo});
      const std::int32_t last = std::min({first.col + kSlabCells - 1, field_.extent.last.col, hi});
      if (from > last) continue;
      std::size_t i = field_.index({from, row});
      if (last - from == kSlabCells - 1 && field_.valid.empty()) {  // eight independent maxima
        const Code* heights = &heights_[i];
        const double first_col = from - plane_.col;
        for (std::size_t k = 0; k < kSlabCells; ++k) {
          const double on_plane = start + plane_.right * (first_col + static_cast<double>(k));
          const double distance = std::abs(static_cast<double>(heights[k]) - on_plane);
          farthest[k] = farthest[k] < distance ? distance : farthest[k];
        }
        continue;
      }
      for (std::int32_t col = from; col <= last; ++col, ++i) {
        if (!field_.is_valid(i)) continue;
        const double on_plane = start + plane_.right * (col - plane_.col);
        largest = std::max(largest, std::abs(static_cast<double>(heights_[i]) - on_plane));
      }
    }
    largest = std::max(largest, *std::max_element(farthest.begin(), farthest.end()));
  }

  /// visit(square), by column and row, for each square of 1 << shift samples that owns samples of the closed triangle.
  template <class Visit>
  static void for_each_square(const HalfDiamond& t, int shift, GridRect within, Visit&& visit) {
    const std::int32_t side = 1 << shift;
    for (std::int32_t y = std::max(t.top(), within.first.row) >> shift;
         y <= std::min(t.bottom(), within.last.row) >> shift; ++y) {
      const auto [lo, hi] = t.columns_over(std::max(t.top(), y * side), std::min(t.bottom(), y * side + side - 1));
      for (std::int32_t x = std::max(lo, within.first.col) >> shift; x <= std::min(hi, within.last.col) >> shift; ++x) {
        visit(GridPoint{x, y});
      }
    }
  }

  const HeightField& field_;
  std::span<const Code> heights_;
  std::span<const BlockShape> shapes_;
  GridRect blocks_;
  const BlockKernel& kernel_ = block_kernel();
  Plane<double> plane_;
  std::vector<Candidate> candidates_;
};

template <class Call>
void by_type(const HeightField& field, Call&& call) {
  std::visit([&](auto heights) { call(std::remove_const_t<typename decltype(heights)::element_type>{}); },
             field.heights);
}

}  // namespace

std::vector<BlockShape> block_shapes(const HeightField& field, GridRect blocks) {
  std::vector<BlockShape> shapes;
  shapes.reserve(static_cast<std::size_t>(blocks.samples()));
  by_type(field, [&](auto code) {
    Shapes<decltype(code)> of(field);
    for_each_point(blocks, [&](GridPoint b) { shapes.push_back(of.shape({b.col * kBlockSide, b.row * kBlockSide})); });
  });
  return shapes;
}

void largest_distances(const HeightField& field, std::span<const BlockShape> shapes, GridRect blocks,
                       std::span<const HalfDiamond> halves, std::span<double> distances) {
  by_type(field, [&](auto code) {
    Distances<decltype(code)> over(field, shapes, blocks);
    for (std::size_t i = 0; i < halves.size(); ++i) distances[i] = over.largest(halves[i]);
  });
}

}  // namespace talus::detail
