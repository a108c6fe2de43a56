#pragma once
// The numbers of a dense page, one at a time and by the book: for numbers of 64 bits, and what all kernels are compared
// with.

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <type_traits>
#include <vector>

#include "engine/dense/dense_kernel.hpp"

namespace talus::detail {

/// A grid of one level, with one number more on each side.
template <class T>
class PlainGrid {
 public:
  explicit PlainGrid(int side) : side_(side), numbers_(static_cast<std::size_t>((side + 2) * (side + 2))) {}
  T& operator()(int col, int row) { return numbers_[static_cast<std::size_t>((row + 1) * (side_ + 2) + col + 1)]; }
  T operator()(int col, int row) const { return numbers_[static_cast<std::size_t>((row + 1) * (side_ + 2) + col + 1)]; }
  [[nodiscard]] int side() const { return side_; }

  /// Continues the grid by one number on each side, on the line through the two before it.
  void extend() {
    const auto line = [](T a, T b) { return static_cast<T>(2 * a - b); };
    PlainGrid& grid = *this;
    const int last = side_ - 1;
    for (int row = 0; row < side_; ++row) {
      grid(-1, row) = line(grid(0, row), grid(1, row));
      grid(side_, row) = line(grid(last, row), grid(last - 1, row));
    }
    for (int col = -1; col <= side_; ++col) {
      grid(col, -1) = line(grid(col, 0), grid(col, 1));
      grid(col, side_) = line(grid(col, last), grid(col, last - 1));
    }
  }

 private:
  int side_;
  std::vector<T> numbers_;
};

/// The two second differences around a number: their sum, and the sum of their sizes.
template <class T>
struct PlainBends {
  T sum = 0, size = 0;
};

template <class T>
class PlainLevel {
 public:
  /// A grid whose numbers are all known.
  explicit PlainLevel(const PlainGrid<T>& even) : even_(even), centres_(even.side()) { even_.extend(); }

  PlainGrid<T>& centres() { return centres_; }
  /// Call it when all centres are known.
  void extend_centres() { centres_.extend(); }

  struct Prediction {
    T number, bent;
  };
  [[nodiscard]] Prediction centre(int col, int row) const {
    return predicted({even_(col, row), even_(col + 1, row), even_(col, row + 1), even_(col + 1, row + 1)},
                     {straight(col, row), straight(col + 1, row), straight(col, row + 1), straight(col + 1, row + 1)});
  }
  /// The side midpoint east of even number (col, row).
  [[nodiscard]] Prediction along(int col, int row) const {
    return predicted({even_(col, row), even_(col + 1, row), centres_(col, row - 1), centres_(col, row)},
                     {diagonal(col, row), diagonal(col + 1, row), of_centre(col, row - 1), of_centre(col, row)});
  }
  /// The one south of it.
  [[nodiscard]] Prediction down(int col, int row) const {
    return predicted({even_(col, row), even_(col, row + 1), centres_(col - 1, row), centres_(col, row)},
                     {diagonal(col, row), diagonal(col, row + 1), of_centre(col - 1, row), of_centre(col, row)});
  }

 private:
  using Signed = std::make_signed_t<T>;
  static T shifted(T v, int by) { return static_cast<T>(static_cast<Signed>(v) >> by); }
  static T size(T v) { return static_cast<Signed>(v) < 0 ? static_cast<T>(0 - v) : v; }

  static Prediction predicted(const std::array<T, 4>& near, const std::array<PlainBends<T>, 4>& bends) {
    T rise = 0, sum = 0, bent = 0;
    for (int i = 0; i < 4; ++i) {
      const auto k = static_cast<std::size_t>(i);
      rise = static_cast<T>(rise + (near[k] - near[0]));
      sum = static_cast<T>(sum + bends[k].sum);
      bent = static_cast<T>(bent + bends[k].size);
    }
    const T corrected = static_cast<T>(rise - shifted(static_cast<T>(3 * sum), 4) + 2);
    return {static_cast<T>(near[0] + shifted(corrected, 2)), bent};
  }
  static PlainBends<T> bends(T at, T a0, T a1, T b0, T b1) {
    const T a = static_cast<T>(a0 + a1 - 2 * at), b = static_cast<T>(b0 + b1 - 2 * at);
    return {static_cast<T>(a + b), static_cast<T>(size(a) + size(b))};
  }
  /// Bends beyond the last or before the first number are those of that number.
  [[nodiscard]] int inside(int v) const { return std::clamp(v, 0, even_.side() - 1); }
  [[nodiscard]] PlainBends<T> straight(int col, int row) const {
    const int c = inside(col), r = inside(row);
    return bends(even_(c, r), even_(c - 1, r), even_(c + 1, r), even_(c, r - 1), even_(c, r + 1));
  }
  [[nodiscard]] PlainBends<T> diagonal(int col, int row) const {
    const int c = inside(col), r = inside(row);
    return bends(even_(c, r), centres_(c - 1, r - 1), centres_(c, r), centres_(c, r - 1), centres_(c - 1, r));
  }
  [[nodiscard]] PlainBends<T> of_centre(int col, int row) const {
    const int c = inside(col), r = inside(row);
    return bends(centres_(c, r), even_(c, r), even_(c + 1, r + 1), even_(c + 1, r), even_(c, r + 1));
  }

  PlainGrid<T> even_, centres_;
};

/// Where the numbers of a row of one kind lie in the square.
struct PlainRow {
  int x, y, step, count;  ///< number i is at (x + i·step, y)
};

/// Visits all numbers in coding order, sixteen at a time.
/// group(PlainRow, first, predictions, sum of bends)  settles numbers `first` to `first` + 15 of a row in the square
/// end(pass)                                          after each of the six passes
template <class T, class Group, class End>
void walk_plainly(T* square, int bend_shift, Group&& group, End&& end) {
  using Prediction = typename PlainLevel<T>::Prediction;
  int pass = 0;
  for (int s = 1 << (kDenseLevels - 1); s >= 1; s /= 2) {
    const int side = kDenseSide / (2 * s);
    PlainGrid<T> even(side);
    for (int row = 0; row < side; ++row) {
      for (int col = 0; col < side; ++col) even(col, row) = square[2 * s * (row * kDenseSide + col)];
    }
    PlainLevel<T> level(even);
    const auto settle = [&](const PlainRow& row, auto&& predict) {
      for (int first = 0; first < row.count; first += kGroup) {
        T predictions[kGroup];
        unsigned sum = 0;
        for (int i = 0; i < kGroup; ++i) {
          const Prediction p = predict(first + i);
          predictions[i] = p.number;
          constexpr T kLargest = std::numeric_limits<T>::max();
          const T below = static_cast<T>((T{1} << bend_shift) - 1);
          const T up = p.bent > kLargest - below ? kLargest : static_cast<T>(p.bent + below);
          sum += static_cast<unsigned>(std::min<T>(static_cast<T>(up >> bend_shift), 255));
        }
        group(row, first, predictions, sum);
      }
    };
    for (int row = 0; row < side; ++row) {
      settle(PlainRow{s, (2 * row + 1) * s, 2 * s, side}, [&](int col) { return level.centre(col, row); });
    }
    end(pass++);
    for (int row = 0; row < side; ++row) {
      for (int col = 0; col < side; ++col)
        level.centres()(col, row) = square[(2 * row + 1) * s * kDenseSide + (2 * col + 1) * s];
    }
    level.extend_centres();
    for (int row = 0; row < side; ++row) {
      settle(PlainRow{s, 2 * row * s, 2 * s, side}, [&](int col) { return level.along(col, row); });
      settle(PlainRow{0, (2 * row + 1) * s, 2 * s, side}, [&](int col) { return level.down(col, row); });
    }
    end(pass++);
  }
}

inline bool is_stored(const std::uint64_t (*stored)[2], int x, int y) {
  return stored == nullptr || (stored[y][x / 64] >> (x % 64) & 1) != 0;
}

template <class T>
bool read_plainly(const DenseStreams& in, T* square, DenseMemory<T>&) {
  std::size_t one_at = 0, flag_at = 0, low_at = 0, patch = 0;  // the first two in bits
  bool enough = true;
  const auto bit = [](const std::uint8_t* from, std::size_t at) { return (from[at / 8] >> (at % 8) & 1) != 0; };
  const auto next_high = [&] {
    std::uint8_t zeros = 0;  // modulo 256
    for (;; ++one_at, ++zeros) {
      if (one_at >= 8 * in.unary_bytes) {
        enough = false;
        return std::uint8_t{0};
      }
      if (bit(in.unary, one_at)) break;
    }
    ++one_at;
    return zeros;
  };
  const auto group = [&](const PlainRow& row, int first, const T* predictions, unsigned sum) {
    const auto place = [&](int i) { return row.y * kDenseSide + row.x + (first + i) * row.step; };
    int stored = 0;
    for (int i = 0; i < kGroup; ++i) {
      square[place(i)] = predictions[i];
      stored += is_stored(in.stored, place(i) % kDenseSide, row.y) ? 1 : 0;
    }
    if (stored == 0 || !enough) return;
    int low_bits = in.low_bits_of[bend_place(sum)];
    if (low_bits >= kFlagged) {
      if (bit(in.flags, flag_at++)) return;
      low_bits -= kFlagged;
    }
    const std::size_t bytes = (static_cast<std::size_t>(stored * low_bits) + 7) / 8;
    if (low_at + bytes > in.low_bytes) {
      enough = false;
      return;
    }
    std::size_t low_bit = 8 * low_at;
    for (int i = 0; i < kGroup; ++i) {
      if (!is_stored(in.stored, place(i) % kDenseSide, row.y)) continue;
      std::uint64_t zigzag = std::uint64_t{next_high()} << low_bits;
      for (int k = 0; k < low_bits; ++k) zigzag |= std::uint64_t{bit(in.low, low_bit++) ? 1u : 0u} << k;
      square[place(i)] = static_cast<T>(square[place(i)] + static_cast<T>(zigzag >> 1 ^ (0 - (zigzag & 1))));
    }
    low_at += bytes;
  };
  const auto pass_of = [](int x, int y) {
    const int s = (x | y) & -(x | y) & 7;
    return s == 0 ? -1 : 2 * (2 - std::countr_zero(static_cast<unsigned>(s))) + ((x & y & s) != 0 ? 0 : 1);
  };
  walk_plainly(square, in.bend_shift, group, [&](int pass) {
    for (; patch < in.patches; ++patch) {
      const int x = in.patched[patch] % kDenseSide, y = in.patched[patch] / kDenseSide;
      if (pass_of(x, y) != pass) break;
      square[y * kDenseSide + x] = static_cast<T>(in.patch_values[patch]);
    }
  });
  std::size_t ones_left = 0;
  for (; one_at < 8 * in.unary_bytes; ++one_at) ones_left += bit(in.unary, one_at) ? 1 : 0;
  return enough && ones_left == 0 && low_at == in.low_bytes && (in.all_flagged || (flag_at + 7) / 8 == in.flag_bytes) &&
         patch == in.patches;
}

template <class T>
void predict_plainly(T* square, const std::uint64_t (*stored)[2], int bend_shift, DenseMemory<T>&, Residuals<T>& out) {
  int number = 0;
  walk_plainly(
      square, bend_shift,
      [&](const PlainRow& row, int first, const T* predictions, unsigned sum) {
        unsigned bits = 0;
        for (int i = 0; i < kGroup; ++i) {
          const int x = row.x + (first + i) * row.step;
          T& at = square[row.y * kDenseSide + x];
          if (is_stored(stored, x, row.y)) {
            bits |= 1u << i;
          } else {
            at = predictions[i];
          }
          const T d = static_cast<T>(at - predictions[i]);
          out.zigzag[number + i] =
              static_cast<T>(static_cast<T>(d << 1) ^ static_cast<T>(0 - (d >> (8 * sizeof(T) - 1))));
        }
        out.bend_sums[number / kGroup] = static_cast<std::uint16_t>(sum);
        out.stored[number / kGroup] = static_cast<std::uint16_t>(bits);
        number += kGroup;
      },
      [](int) {});
}

template <class T>
inline constexpr DenseFunctions<T> kPlainDense = {&read_plainly<T>, &predict_plainly<T>};

}  // namespace talus::detail
