#include "engine/page/page_errors.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "engine/error/vertex_error.hpp"
#include "engine/machine/cpu.hpp"

namespace talus {
namespace {

constexpr int kBlock = 8;                   ///< implied errors repeat in blocks of 8²
constexpr int kLanes = kPageSide / kBlock;  ///< blocks in a row, one for each lane of a vector
static_assert(kPageSide == 128 && kBandLevels == 3);

constexpr int reach_of(int s, bool centre) {
  if (s == 1) return 1;
  const int side = std::max(s, s / 2 + reach_of(s / 2, true));
  return centre ? s + side : side;
}
static_assert(reach_of(2, false) == 2 && reach_of(2, true) == 4 && reach_of(4, false) == 6 && reach_of(4, true) == 10);

/// The spacing of a vertex; 8 for vertices of a coarser band.
constexpr int spacing_in_block(std::int32_t col, std::int32_t row) {
  const int bits = static_cast<int>((col | row) & (kBlock - 1));
  return bits == 0 ? kBlock : bits & -bits;
}

}  // namespace

bool is_implied_by_place(std::int32_t col, std::int32_t row, const PresentRect& present) {
  const int s = spacing_in_block(col, row);
  if (s == kBlock) return false;
  const bool col_odd = (col & s) != 0, row_odd = (row & s) != 0, side = col_odd != row_odd;
  const auto has = [&](std::int32_t c, std::int32_t r) {
    return c >= present.first_col && c < present.end_col && r >= present.first_row && r < present.end_row;
  };
  if (s == 1 && side) {
    return col_odd ? has(col - 1, row) && has(col + 1, row) && (has(col, row - 1) || has(col, row + 1))
                   : has(col, row - 1) && has(col, row + 1) && (has(col - 1, row) || has(col + 1, row));
  }
  const int reach = reach_of(s, !side);
  return has(col - reach, row - reach) && has(col + reach, row + reach);
}

namespace {

#pragma GCC diagnostic ignored "-Wpsabi"  // only inlined functions have vector arguments

template <class Distance>
struct Vector {
  typedef Distance V __attribute__((vector_size(64)));  // gcc splits wider vectors into single numbers
};

// A page's square, each row sorted by the place of a column in its block: kLanes numbers for each place. Whole numbers
// are unsigned, so that the heights of a damaged page wrap around instead of overflow.
template <class Distance>
struct Sorted {
  using Unsigned = std::conditional_t<std::is_same_v<Distance, double>, double, std::uint32_t>;
  using V = typename Vector<Unsigned>::V;
  using Signed = typename Vector<Distance>::V;
  static constexpr int kWidth = 64 / sizeof(Distance);
  static constexpr std::size_t kRim = 2 * kLanes;

  alignas(64) Unsigned numbers[kRim + kSquare + kRim]{};
  alignas(64) Unsigned errors[kRim + kSquare + kRim]{};
  /// For pages without voids: not 0 if implied by place. in_part: for pages with the rectangle `part_of`.
  alignas(64) Distance in_whole_page[kSquare]{}, in_part[kSquare]{};
  PresentRect part_of{0, 0, 0, 0};
  bool has_whole_page = false;
  std::ptrdiff_t part = 0;  ///< first of the lanes that are computed now
  alignas(64) Distance is_implied_here[kSquare]{};

  static std::ptrdiff_t place(int col, int row) {
    return static_cast<std::ptrdiff_t>(kRim) + row * kPageSide + (col & (kBlock - 1)) * kLanes + (col >> 3);
  }
  [[gnu::always_inline]] V load(const Unsigned* from, int col, int row) const {
    V v;
    std::memcpy(&v, from + place(col, row) + part, sizeof v);
    return v;
  }
  [[gnu::always_inline]] void store(int col, int row, const V& v) {
    std::memcpy(errors + place(col, row) + part, &v, sizeof v);
  }
  [[gnu::always_inline]] V at(int col, int row) const { return load(numbers, col, row); }

  [[gnu::always_inline]] static V larger(const V& a, const V& b) {
    const auto x = reinterpret_cast<Signed>(a), y = reinterpret_cast<Signed>(b);
    return reinterpret_cast<V>(x > y ? x : y);
  }
  [[gnu::always_inline]] static V smaller(const V& a, const V& b) {
    const auto x = reinterpret_cast<Signed>(a), y = reinterpret_cast<Signed>(b);
    return reinterpret_cast<V>(x < y ? x : y);
  }
  /// Divides by a power of two. The numbers are multiples of it.
  template <int shift>
  [[gnu::always_inline]] static V over(const V& a) {
    if constexpr (std::is_same_v<Distance, double>) {
      return a * (1.0 / (1 << shift));
    } else {
      return reinterpret_cast<V>(reinterpret_cast<Signed>(a) >> shift);
    }
  }

  /// The largest distances above and below the surface.
  struct Range {
    V above{}, below{};
    [[gnu::always_inline]] void take(const V& residual) {
      above = larger(above, residual);
      below = smaller(below, residual);
    }
    [[gnu::always_inline]] V largest() const { return larger(above, V{} - below); }
  };

  /// Measures a half-diamond of a centre with its right angle at (col, row) and legs of 2s cells.
  /// hypotenuse  whether the samples on it count, too
  template <int s>
  [[gnu::always_inline]] void corner(int col, int row, int east, int south, bool hypotenuse, Range& range) const {
    constexpr int shift = s == 1 ? 1 : s == 2 ? 2 : 3;
    const V base = at(col, row);
    const V right = over<shift>(at(col + 2 * s * east, row) - base);
    const V down = over<shift>(at(col, row + 2 * s * south) - base);
    V start = base;
    for (int v = 1; v < 2 * s; ++v) {
      start += down;
      V surface = start;
      for (int u = 1; u <= 2 * s - v - (hypotenuse ? 0 : 1); ++u) {
        surface += right;
        range.take(at(col + u * east, row + v * south) - surface);
      }
    }
  }
  /// The error of a centre. falling: its diagonal goes from north-west to south-east.
  template <int s>
  [[gnu::always_inline]] V centre(int col, int row, bool falling) const {
    Range range;
    const int tilt = falling ? 1 : -1;  // direction from the centre to the northern apex
    corner<s>(col + s * tilt, row - s, -tilt, 1, true, range);
    corner<s>(col - s * tilt, row + s, tilt, -1, false, range);
    return range.largest();
  }
  /// The error of a side midpoint. level: its side lies along the row, not the column.
  template <int s>
  [[gnu::always_inline]] V side(int col, int row, bool level) const {
    constexpr int shift = s == 1 ? 0 : s == 2 ? 1 : 2;
    const auto place_of = [&](int along, int across) __attribute__((always_inline)) {
      return level ? at(col + along, row + across) : at(col + across, row + along);
    };
    const V a = place_of(-s, 0), b = place_of(s, 0), middle = over<1>(a + b), slope = over<shift + 1>(b - a);
    Range range;
    V surface = a;
    for (int t = 1 - s; t < s; ++t) {
      surface += slope;
      range.take(place_of(t, 0) - surface);
    }
    for (const int half : {-1, 1}) {
      if (s == 1) break;  // no sample inside
      const V rise = over<shift>(place_of(0, half * s) - middle);
      V start = a;
      for (int n = 1; n < s; ++n) {
        start += rise + slope;
        V inner = start;
        for (int t = n - s + 1; t < s - n; ++t) {
          inner += slope;
          range.take(place_of(t, half * n) - inner);
        }
      }
    }
    return range.largest();
  }

  /// Stores the saturated error: the largest of the own error and those of the four children.
  template <int s>
  [[gnu::always_inline]] void compute_side(int col, int row, bool level) {
    V e = side<s>(col, row, level);
    constexpr int h = s / 2;
    if (s > 1) {
      e = larger(larger(e, larger(load(errors, col - h, row - h), load(errors, col + h, row - h))),
                 larger(load(errors, col - h, row + h), load(errors, col + h, row + h)));
    }
    store(col, row, e);
  }
  template <int s>
  [[gnu::always_inline]] void compute_centre(int col, int row) {
    V e;
    if constexpr (s < kBlock / 2) {
      e = centre<s>(col, row, (((col - s) ^ (row - s)) & (2 * s)) == 0);
    } else {
      // Diagonals alternate between neighbouring blocks.
      const V falling = centre<s>(col, row, true), rising = centre<s>(col, row, false);
      Signed odd_block{};
      for (int lane = 0; lane < kWidth; ++lane) odd_block[lane] = static_cast<Distance>((lane ^ (row >> 3)) & 1);
      e = odd_block != 0 ? rising : falling;
    }
    e = larger(larger(e, larger(load(errors, col - s, row), load(errors, col + s, row))),
               larger(load(errors, col, row - s), load(errors, col, row + s)));
    store(col, row, e);
  }
  /// Computes a level, for rows of `present`. Rows with neighbours outside the square have no implied vertices, and are
  /// left out.
  template <int s>
  [[gnu::always_inline]] void level(const PresentRect& present) {
    const int first = (present.first_row + s - 1) & -s;
    for (int row = first; row < present.end_row; row += s) {
      const bool row_odd = (row & s) != 0;
      const bool inside = row >= s && row + s < kPageSide;
      for (int col = row_odd ? 0 : s; col < kBlock; col += 2 * s) {
        if (!inside && (s > 1 || row_odd)) break;
        for (part = 0; part < kLanes; part += kWidth) compute_side<s>(col, row, !row_odd);
      }
    }
    for (int row = first | s; row < present.end_row && row + s < kPageSide; row += 2 * s) {
      for (int col = s; col < kBlock; col += 2 * s) {
        for (part = 0; part < kLanes; part += kWidth) compute_centre<s>(col, row);
      }
    }
  }

  /// Copies a square in. Rows outside `present` keep old numbers, because no implied error depends on them.
  [[gnu::always_inline]] void take_in(const Distance* square, const PresentRect& present) {
    for (int row = present.first_row; row < present.end_row; ++row) {
      const Distance* from = square + row * kPageSide;
      Unsigned *to = numbers + kRim + row * kPageSide, halves[kPageSide], quarters[kPageSide];
      // Sorts three times: even places first, then odd ones.
      for (int i = 0; i < 64; ++i) {
        halves[i] = static_cast<Unsigned>(from[2 * i]);
        halves[64 + i] = static_cast<Unsigned>(from[2 * i + 1]);
      }
      for (int k = 0; k < 128; k += 64) {
        for (int i = 0; i < 32; ++i) quarters[k + i] = halves[k + 2 * i], quarters[k + 32 + i] = halves[k + 2 * i + 1];
      }
      for (int k = 0; k < 4; ++k) {  // columns 0, 2, 1, 3 modulo 4
        const int first = (k >> 1) + 2 * (k & 1);
        const Unsigned scale = std::is_same_v<Distance, double> ? 1 : kBlock;
        for (int i = 0; i < 16; ++i) {
          to[first * kLanes + i] = quarters[32 * k + 2 * i] * scale;
          to[(first + 4) * kLanes + i] = quarters[32 * k + 2 * i + 1] * scale;
        }
      }
    }
  }
  [[gnu::always_inline]] void hand_out(const Distance* implied, const PresentRect& present, Distance* distances) const {
    std::fill_n(distances, present.first_row * kPageSide, Distance{-1});
    std::fill(distances + present.end_row * kPageSide, distances + kSquare, Distance{-1});
    for (int row = present.first_row; row < present.end_row; ++row) {
      Distance *to = distances + row * kPageSide, halves[kPageSide], quarters[kPageSide];
      const Unsigned* from = errors + kRim + row * kPageSide;
      const Distance* mask = implied + row * kPageSide;
      for (int k = 0; k < 4; ++k) {
        const int first = (k >> 1) + 2 * (k & 1);
        for (int i = 0; i < 16; ++i) {
          const int one = first * kLanes + i, other = one + 4 * kLanes;
          quarters[32 * k + 2 * i] = mask[one] != 0 ? static_cast<Distance>(from[one]) : Distance{-1};
          quarters[32 * k + 2 * i + 1] = mask[other] != 0 ? static_cast<Distance>(from[other]) : Distance{-1};
        }
      }
      for (int k = 0; k < 128; k += 64) {
        for (int i = 0; i < 32; ++i) halves[k + 2 * i] = quarters[k + i], halves[k + 2 * i + 1] = quarters[k + 32 + i];
      }
      for (int i = 0; i < 64; ++i) to[2 * i] = halves[i], to[2 * i + 1] = halves[64 + i];
    }
  }
};

TALUS_CLONES void compute_lanes(Sorted<std::int32_t>& s, const std::int32_t* square, const PresentRect& present,
                                const std::int32_t* implied, std::int32_t* distances) {
  s.take_in(square, present);
  s.level<1>(present);
  s.level<2>(present);
  s.level<4>(present);
  s.hand_out(implied, present, distances);
}
TALUS_CLONES void compute_lanes(Sorted<double>& s, const double* square, const PresentRect& present,
                                const double* implied, double* distances) {
  s.take_in(square, present);
  s.level<1>(present);
  s.level<2>(present);
  s.level<4>(present);
  s.hand_out(implied, present, distances);
}

/// The number of voids in the rectangle from the north-west corner to each sample.
class VoidCount {
 public:
  explicit VoidCount(std::span<const std::uint8_t> valid) : sums_((kPageSide + 1) * (kPageSide + 1)) {
    if (valid.empty()) return;
    for (int row = 0; row < kPageSide; ++row) {
      for (int col = 0; col < kPageSide; ++col) {
        at(col + 1, row + 1) = at(col, row + 1) + at(col + 1, row) - at(col, row) +
                               (valid[static_cast<std::size_t>(row * kPageSide + col)] == 0 ? 1 : 0);
      }
    }
  }
  [[nodiscard]] bool none(int first_col, int first_row, int last_col, int last_row) {
    return at(last_col + 1, last_row + 1) - at(first_col, last_row + 1) - at(last_col + 1, first_row) +
               at(first_col, first_row) ==
           0;
  }

 private:
  int& at(int col, int row) { return sums_[static_cast<std::size_t>(row * (kPageSide + 1) + col)]; }
  std::vector<int> sums_;
};

/// Whether a finest side midpoint, its ends and one of its apexes are valid. Its error depends on them alone: without a
/// valid apex, no triangle with data has the midpoint as a corner.
struct FinestData {
  const PresentRect& present;
  std::span<const std::uint8_t> valid;

  [[nodiscard]] bool at(int col, int row) const {
    return col >= present.first_col && col < present.end_col && row >= present.first_row && row < present.end_row &&
           valid[static_cast<std::size_t>(row * kPageSide + col)] != 0;
  }
  /// across  1 if the side lies along the row, otherwise 0
  [[nodiscard]] bool around_side(int col, int row, int across) const {
    const int c = across, r = 1 - across;
    return at(col, row) && at(col - c, row - r) && at(col + c, row + r) &&
           (at(col - r, row - c) || at(col + r, row + c));
  }
};

/// Calls visit(col, row) for every implied vertex.
template <class Visit>
void for_each_implied(const PresentRect& present, std::span<const std::uint8_t> valid, Visit&& visit) {
  VoidCount voids(valid);
  const FinestData data{present, valid};
  const auto all_data = [&](int col, int row, int s) {
    const bool col_odd = (col & s) != 0, row_odd = (row & s) != 0, side = col_odd != row_odd;
    if (s == 1 && side) return data.around_side(col, row, col_odd ? 1 : 0);
    const int reach = reach_of(s, !side);
    return voids.none(col - reach, row - reach, col + reach, row + reach);
  };
  for (int row = present.first_row; row < present.end_row; ++row) {
    for (int col = present.first_col; col < present.end_col; ++col) {
      const int s = spacing_in_block(col, row);
      if (s < kBlock && is_implied_by_place(col, row, present) && (valid.empty() || all_data(col, row, s)))
        visit(col, row);
    }
  }
}

}  // namespace

template <class Distance>
struct ImpliedErrors<Distance>::Lanes : Sorted<Distance> {};

template <class Distance>
ImpliedErrors<Distance>::ImpliedErrors() : lanes_(std::make_shared<Lanes>()) {}

template <class Distance>
void ImpliedErrors<Distance>::compute(std::span<const Distance> square, const PresentRect& present,
                                      std::span<const std::uint8_t> valid, std::span<Distance> distances) {
  Lanes& lanes = *lanes_;
  const auto mark = [&](Distance* marks) {
    std::fill_n(marks, kSquare, Distance{0});
    for_each_implied(present, valid, [&](int col, int row) {
      marks[Lanes::place(col, row) - static_cast<std::ptrdiff_t>(Lanes::kRim)] = 1;
    });
  };
  const Distance* implied = lanes.in_whole_page;
  if (!valid.empty()) {
    mark(lanes.is_implied_here);
    implied = lanes.is_implied_here;
  } else if (present != PresentRect{}) {
    if (lanes.part_of != present) mark(lanes.in_part);
    lanes.part_of = present;
    implied = lanes.in_part;
  } else if (!lanes.has_whole_page) {
    mark(lanes.in_whole_page);
    lanes.has_whole_page = true;
  }
  compute_lanes(lanes, square.data(), present, implied, distances.data());
}

template class ImpliedErrors<std::int32_t>;
template class ImpliedErrors<double>;

namespace {

/// Distance of h from the middle of a and b, rounded up unless it is exact.
double distance_rounded_up(double a, double b, double h) {
  const auto lost = [](double one, double other, double sum) {  // exact rounding error of the sum [Knuth's two-sum]
    const double back = sum - one;
    return (one - (sum - back)) + (other - back);
  };
  if (halves_exactly(a, b, h)) return 0;
  const double sum = a + b, middle = sum / 2, d = h - middle;
  const bool exact = lost(a, b, sum) == 0 && middle * 2 == sum && lost(h, -middle, d) == 0;
  // For doubles of at least 0, adding 1 to the bits makes the next double.
  constexpr auto kInfinite = std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());
  const auto bits = std::bit_cast<std::uint64_t>(std::abs(d));
  return std::bit_cast<double>(exact || bits >= kInfinite ? bits : std::min(bits + 2, kInfinite));
}

}  // namespace

void implied_errors_rounded_up(std::span<const double> square, const PresentRect& present,
                               std::span<const std::uint8_t> valid, std::span<double> distances) {
  std::fill(distances.begin(), distances.end(), -1.0);
  const FinestData data{present, valid};
  const auto index = [](int col, int row) { return static_cast<std::size_t>(row * kPageSide + col); };
  const auto residual = [&](std::size_t i, std::size_t step) {
    return distance_rounded_up(square[i - step], square[i + step], square[i]);
  };
  // Columns and rows with neighbours on both sides. A side midpoint needs both ends, and an apex on one side.
  const int first_col = present.first_col + 1, end_col = present.end_col - 1;
  const int first_row = present.first_row + 1, end_row = present.end_row - 1;
  if (present.end_row - present.first_row > 1) {
    for (int row = present.first_row + (present.first_row & 1); row < present.end_row; row += 2) {
      for (int col = first_col | 1; col < end_col; col += 2) {
        if (valid.empty() || data.around_side(col, row, 1)) distances[index(col, row)] = residual(index(col, row), 1);
      }
    }
  }
  if (present.end_col - present.first_col > 1) {
    for (int row = first_row | 1; row < end_row; row += 2) {
      for (int col = present.first_col + (present.first_col & 1); col < present.end_col; col += 2) {
        if (valid.empty() || data.around_side(col, row, 0))
          distances[index(col, row)] = residual(index(col, row), kPageSide);
      }
    }
  }
  const auto all_data = [&](int col, int row) {
    for (const int r : {row - 1, row, row + 1}) {
      const std::uint8_t* three = &valid[index(col - 1, r)];
      if (three[0] == 0 || three[1] == 0 || three[2] == 0) return false;
    }
    return true;
  };
  for (int row = first_row | 1; row < end_row; row += 2) {
    for (int col = first_col | 1; col < end_col; col += 2) {
      if (!valid.empty() && !all_data(col, row)) continue;
      const std::size_t i = index(col, row);
      const bool falling = ((col ^ row) & 2) == 0;
      const double around = std::max(std::max(distances[i - 1], distances[i + 1]),
                                     std::max(distances[i - kPageSide], distances[i + kPageSide]));
      distances[i] = std::max(residual(i, falling ? kPageSide + 1 : kPageSide - 1), around);
    }
  }
}

}  // namespace talus
