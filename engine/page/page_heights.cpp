#include "engine/page/page_heights.hpp"

#include <algorithm>
#include <bit>
#include <type_traits>

#include "engine/machine/cpu.hpp"

namespace talus {
namespace {

/// A grid of up to 64² numbers of one level with a rim: one number before, two after.
constexpr std::ptrdiff_t kStride = 80, kBefore = 8;
constexpr std::size_t kGrid = static_cast<std::size_t>(kStride) * 68;
constexpr int kHalf = kPageSide / 2;

template <class Number>
using Wrapping = std::make_unsigned_t<Number>;

template <class Number>
constexpr Number* row_of(Number* grid, int row) {
  return grid + (row + 1) * kStride + kBefore;
}

/// A part of a level's grid: columns first_col to end_col - 1, rows alike.
struct PagePiece {
  int first_col, end_col, first_row, end_row;

  [[nodiscard]] PagePiece grown(int before, int behind, int side) const {
    return {std::max(first_col - before, 0), std::min(end_col + behind, side), std::max(first_row - before, 0),
            std::min(end_row + behind, side)};
  }
  [[nodiscard]] PagePiece halved() const {
    return {first_col / 2, (end_col + 1) / 2, first_row / 2, (end_row + 1) / 2};
  }
};

/// The parts of a level to compute so that the wanted numbers of all four kinds are right. Side midpoints are predicted
/// from the centres and even ones around them, centres from two even ones on each side.
struct Parts {
  PagePiece sides, centres, even;
  Parts(const PagePiece& wanted, int side)
      : sides(wanted.halved()), centres(sides.grown(1, 1, side)), even(sides.grown(2, 3, side)) {}
};

/// The position of one kind's numbers in the square, and the part to compute.
struct Kind {
  std::size_t first, along, down;
  int side;
  PagePiece part;
  [[nodiscard]] std::size_t at(int col, int row) const {
    return first + static_cast<std::size_t>(col) * along + static_cast<std::size_t>(row) * down;
  }
};

/// Continues the grid over its sides: each number of the rim is on the line through the two before it. `part` must hold
/// these two where it touches a side.
template <class Number>
void extend(Wrapping<Number>* grid, int side, const PagePiece& part) {
  using W = Wrapping<Number>;
  const auto on = [&](W a, W b) { return side > 1 ? static_cast<W>(2 * a - b) : a; };
  for (int row = part.first_row; row < part.end_row; ++row) {
    W* p = row_of(grid, row);
    p[-1] = on(p[0], p[side > 1 ? 1 : 0]);
    p[side] = on(p[side - 1], p[side > 1 ? side - 2 : 0]);
    p[side + 1] = on(p[side], p[side - 1]);
  }
  const auto line = [&](int to, int near, int far) {
    for (int col = part.first_col - 1; col < part.end_col + 2; ++col)
      row_of(grid, to)[col] = on(row_of(grid, near)[col], row_of(grid, far)[col]);
  };
  if (part.first_row == 0) line(-1, 0, side > 1 ? 1 : 0);
  if (part.end_row < side) return;
  line(side, side - 1, side > 1 ? side - 2 : 0);
  line(side + 1, side, side - 1);
}

/// Four neighbours a b / c d in a square, and the eight numbers one step beyond them along its sides: ab is next to a,
/// away from b.
template <class W>
struct Around {
  const W *a, *b, *c, *d, *ab, *ba, *cd, *dc, *ac, *ca, *bd, *db;
};

template <class Number>
[[gnu::always_inline]] inline void predict_row(const Around<Wrapping<Number>>& n, int count,
                                               Wrapping<Number>* __restrict predicted,
                                               std::uint8_t* __restrict contexts) {
  using W = Wrapping<Number>;
  const auto size = [](W v) {
    const W sign = static_cast<W>(static_cast<Number>(v) >> (8 * sizeof(W) - 1));
    return (v ^ sign) - sign;
  };
  std::int32_t classes[kHalf];  // as wide as the numbers, so that the loop needs few registers
  for (int i = 0; i < count; ++i) {
    const W a = n.a[i], b = n.b[i], c = n.c[i], d = n.d[i];
    const W bends[8] = {n.ab[i] - 2 * a + b, n.ba[i] - 2 * b + a, n.cd[i] - 2 * c + d, n.dc[i] - 2 * d + c,
                        n.ac[i] - 2 * a + c, n.ca[i] - 2 * c + a, n.bd[i] - 2 * b + d, n.db[i] - 2 * d + b};
    W bend = 0, bent = 1;
    for (const W v : bends) bend += v, bent += size(v);
    // 22/64 of each of the four, minus 3/64 of each of the eight.
    predicted[i] = static_cast<W>(static_cast<Number>(16 * (a + b + c + d) - 3 * bend + 32) >> 6);
    // The highest bit of `bent` and the one below it, as in a float.
    const auto cut = static_cast<std::int32_t>(std::min<W>(bent, (1u << 24) - 1));
    const auto bits = std::bit_cast<std::int32_t>(static_cast<float>(cut));
    classes[i] = std::max((bits >> 22) - 254, 0);
  }
  for (int i = 0; i < count; ++i) contexts[i] = static_cast<std::uint8_t>(classes[i]);
}

}  // namespace

template <class Number>
struct HeightLevels<Number>::Grids {
  using W = Wrapping<Number>;
  // One level: the known numbers, its centres, and its side midpoints along rows and along columns.
  W even[kGrid]{}, centres[kGrid]{};
  W predicted[2 * kHalf * kHalf]{};
  std::uint8_t contexts[2 * kHalf * kHalf]{};
  W numbers[2 * kHalf * kHalf]{}, read[2 * kHalf * kHalf]{};
  W sides[2 * kHalf * kHalf]{};  ///< along rows, then along columns
  std::uint8_t listed[2 * kHalf * kHalf]{};

  TALUS_CLONES static void predict_centres(Grids& g, int side, const Parts& parts) {
    extend<Number>(g.even, side, parts.even);
    const PagePiece& part = parts.centres;
    for (int row = part.first_row; row < part.end_row; ++row) {
      const W *north = row_of(g.even, row - 1) + part.first_col, *here = row_of(g.even, row) + part.first_col,
              *south = row_of(g.even, row + 1) + part.first_col, *beyond = row_of(g.even, row + 2) + part.first_col;
      const int at = row * side + part.first_col;
      predict_row<Number>({here, here + 1, south, south + 1, here - 1, here + 2, south - 1, south + 2, north, beyond,
                           north + 1, beyond + 1},
                          part.end_col - part.first_col, g.predicted + at, g.contexts + at);
    }
  }
  TALUS_CLONES static void predict_sides(Grids& g, int side, const Parts& parts) {
    extend<Number>(g.centres, side, parts.centres);
    const PagePiece& part = parts.sides;
    const int from = part.first_col, count = part.end_col - from;
    for (int row = part.first_row; row < part.end_row; ++row) {
      const W *e0 = row_of(g.even, row - 1) + from, *e1 = row_of(g.even, row) + from,
              *e2 = row_of(g.even, row + 1) + from;
      const W *c0 = row_of(g.centres, row - 1) + from, *c1 = row_of(g.centres, row) + from,
              *c2 = row_of(g.centres, row + 1) + from;
      const int along = row * side + from, down = along + side * side;
      // The same turned by 45 degrees: west, north / south, east.
      predict_row<Number>({e1, c0, c1, e1 + 1, c1 - 1, e0 + 1, e2, c0 + 1, c0 - 1, e2 + 1, e0, c1 + 1}, count,
                          g.predicted + along, g.contexts + along);
      predict_row<Number>({c1 - 1, e1, e2, c1, e2 - 1, c0, c2 - 1, e1 + 1, e1 - 1, c2, c0 - 1, e2 + 1}, count,
                          g.predicted + down, g.contexts + down);
    }
  }
  static W zigzag(W v) { return static_cast<W>(v << 1 ^ (0 - (v >> (8 * sizeof(W) - 1)))); }
  /// For a level that is complete.
  TALUS_CLONES static void subtract(Grids& g, int rows, int cols, const W* __restrict values, std::ptrdiff_t stride) {
    for (int row = 0; row < rows; ++row) {
      const W *predicted = g.predicted + row * cols, *from = values + row * stride;
      W* numbers = g.numbers + row * cols;
      for (int i = 0; i < cols; ++i) numbers[i] = zigzag(from[i] - predicted[i]);
    }
  }
  /// values = predicted + residual; `behind` rows of predictions come before.
  TALUS_CLONES static void add(const Grids& g, int side, const PagePiece& part, int behind, W* __restrict values,
                               std::ptrdiff_t stride) {
    for (int row = behind + part.first_row; row < behind + part.end_row; ++row) {
      const W *predicted = g.predicted + row * side, *numbers = g.numbers + row * side;
      W* to = values + row * stride;
      for (int i = part.first_col; i < part.end_col; ++i)
        to[i] = predicted[i] + (numbers[i] >> 1 ^ (0 - (numbers[i] & 1)));
    }
  }
  /// Joins all four kinds into one grid of twice the side; `to` may be the grid of the even ones.
  TALUS_CLONES static void join(const Grids& g, int side, const PagePiece& part, W* to, std::ptrdiff_t stride) {
    const int first = part.first_col, end = part.end_col;
    for (int row = part.end_row; row-- > part.first_row;) {  // backward: each row is read before it is overwritten
      W line[kHalf];
      std::copy_n(row_of(g.even, row) + first, end - first, line + first);
      const W *along = g.sides + row * side, *down = g.sides + (side + row) * side, *centre = row_of(g.centres, row);
      W *upper = to + 2 * row * stride, *lower = upper + stride;
      for (int i = first; i < end; ++i) upper[2 * i] = line[i], upper[2 * i + 1] = along[i];
      for (int i = first; i < end; ++i) lower[2 * i] = down[i], lower[2 * i + 1] = centre[i];
    }
  }
};

template <class Number>
HeightLevels<Number>::HeightLevels() : grids_(std::make_shared<Grids>()) {}

/// settle(kinds, values, stride) computes the numbers of one kind, or of two one after the other, and their values from
/// the predictions and contexts.
template <class Number>
template <class Settle>
void HeightLevels<Number>::run(std::span<Number> square, const PresentRect& present, Settle&& settle) {
  Grids& g = *grids_;
  constexpr std::size_t kRow = kPageSide;
  constexpr int kLevels = kPageShift;
  PagePiece wanted[kLevels + 1];  // by level, whose grid has a side of 1 << level
  wanted[kLevels] = {present.first_col, present.end_col, present.first_row, present.end_row};
  for (int level = kLevels; level-- > 0;) wanted[level] = Parts(wanted[level + 1], 1 << level).even;

  g.predicted[0] = 0;
  g.contexts[0] = kHeightContexts - 1;
  const Kind corner[] = {{0, 0, 0, 1, {0, 1, 0, 1}}};
  settle(std::span(corner), row_of(g.even, 0), 0);
  for (int level = 0; level < kLevels; ++level) {
    const int side = 1 << level;
    const Parts parts(wanted[level + 1], side);
    const std::size_t s = kRow / static_cast<std::size_t>(2 * side), twice = 2 * s;
    const Kind centres[] = {{s * kRow + s, twice, twice * kRow, side, parts.centres}};
    const Kind sides[] = {{s, twice, twice * kRow, side, parts.sides},
                          {s * kRow, twice, twice * kRow, side, parts.sides}};
    Grids::predict_centres(g, side, parts);
    settle(std::span(centres), row_of(g.centres, 0), kStride);
    Grids::predict_sides(g, side, parts);
    settle(std::span(sides), g.sides, side);
    if (side < kHalf) {
      Grids::join(g, side, parts.sides, row_of(g.even, 0), kStride);
    } else {
      Grids::join(g, side, parts.sides, reinterpret_cast<W*>(square.data()), kPageSide);
    }
  }
}

template <class Number>
void HeightLevels<Number>::put(std::span<Number> square, std::span<const std::uint8_t> coded,
                               const PresentRect& present, NumberWriter& out) {
  Grids& g = *grids_;
  run(square, present, [&](std::span<const Kind> kinds, W* values, std::ptrdiff_t stride) {
    const int side = kinds[0].side;
    std::size_t listed = 0;
    for (int k = 0; k < static_cast<int>(kinds.size()); ++k) {
      const Kind& kind = kinds[static_cast<std::size_t>(k)];
      for (int row = kind.part.first_row; row < kind.part.end_row; ++row) {
        W* to = values + (k * side + row) * stride;
        const std::size_t from = kind.at(0, row), i = static_cast<std::size_t>((k * side + row) * side);
        const auto first = static_cast<std::size_t>(kind.part.first_col),
                   end = static_cast<std::size_t>(kind.part.end_col);
        if (coded.empty()) {
          for (std::size_t col = first; col < end; ++col) to[col] = static_cast<W>(square[from + col * kind.along]);
          continue;
        }
        for (std::size_t col = first; col < end; ++col) {
          const bool is_coded = coded[from + col * kind.along] != 0;
          to[col] = is_coded ? static_cast<W>(square[from + col * kind.along]) : g.predicted[i + col];
          g.listed[listed] = g.contexts[i + col];
          g.numbers[listed] = Grids::zigzag(to[col] - g.predicted[i + col]);
          listed += is_coded ? 1 : 0;
        }
      }
    }
    if (coded.empty()) {
      const int rows = static_cast<int>(kinds.size()) * side;
      Grids::subtract(g, rows, side, values, stride);
      out.put(g.numbers, std::span(g.contexts, static_cast<std::size_t>(rows * side)));
    } else {
      out.put(g.numbers, std::span(g.listed, listed));
    }
  });
}

template <class Number>
void HeightLevels<Number>::get(std::span<Number> square, std::span<const std::uint8_t> coded,
                               const PresentRect& present, NumberReader& in) {
  Grids& g = *grids_;
  run(square, present, [&](std::span<const Kind> kinds, W* values, std::ptrdiff_t stride) {
    const int side = kinds[0].side, count = static_cast<int>(kinds.size());
    if (coded.empty()) {
      in.get(std::span(g.contexts, static_cast<std::size_t>(count * side * side)), g.numbers);
    } else {
      const auto for_each_row = [&](auto&& visit) {
        for (int k = 0; k < count; ++k) {
          const Kind& kind = kinds[static_cast<std::size_t>(k)];
          for (int row = kind.part.first_row; row < kind.part.end_row; ++row) visit(kind, row, (k * side + row) * side);
        }
      };
      std::size_t listed = 0;
      for_each_row([&](const Kind& kind, int row, int i) {
        for (int col = kind.part.first_col; col < kind.part.end_col; ++col) {
          if (coded[kind.at(col, row)] != 0) g.listed[listed++] = g.contexts[i + col];
        }
      });
      in.get(std::span(g.listed, listed), g.read);
      listed = 0;
      for_each_row([&](const Kind& kind, int row, int i) {
        for (int col = kind.part.first_col; col < kind.part.end_col; ++col) {
          g.numbers[i + col] = coded[kind.at(col, row)] != 0 ? g.read[listed++] : 0;
        }
      });
    }
    for (int k = 0; k < count; ++k) {
      Grids::add(g, side, kinds[static_cast<std::size_t>(k)].part, k * side, values, stride);
    }
  });
}

template class HeightLevels<std::int32_t>;
template class HeightLevels<std::int64_t>;

}  // namespace talus
