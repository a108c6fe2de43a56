#include "engine/page_heights.hpp"

#include <algorithm>
#include <bit>
#include <type_traits>

#include "engine/vector_clones.hpp"

namespace talus {
namespace {

/// A grid of up to 64² numbers of one level with a rim: one number before, two behind.
constexpr std::ptrdiff_t kStride = 80, kBefore = 8;
constexpr std::size_t kGrid = static_cast<std::size_t>(kStride) * 68;
constexpr int kHalf = kPageSide / 2;

template <class Number>
using Wrapping = std::make_unsigned_t<Number>;

template <class Number>
constexpr Number* row_of(Number* grid, int row) {
  return grid + (row + 1) * kStride + kBefore;
}

/// Straight on over the sides: every number of the rim is where a line through the two before it goes.
template <class Number>
void extend(Wrapping<Number>* grid, int side) {
  using W = Wrapping<Number>;
  const auto on = [&](W a, W b) { return side > 1 ? static_cast<W>(2 * a - b) : a; };
  for (int row = 0; row < side; ++row) {
    W* p = row_of(grid, row);
    p[-1] = on(p[0], p[side > 1 ? 1 : 0]);
    p[side] = on(p[side - 1], p[side > 1 ? side - 2 : 0]);
    p[side + 1] = on(p[side], p[side - 1]);
  }
  const auto line = [&](int to, int near, int far) {
    for (int col = -1; col < side + 2; ++col)
      row_of(grid, to)[col] = on(row_of(grid, near)[col], row_of(grid, far)[col]);
  };
  line(-1, 0, side > 1 ? 1 : 0);
  line(side, side - 1, side > 1 ? side - 2 : 0);
  line(side + 1, side, side - 1);
}

/// Four neighbours a b / c d in a square, and the eight numbers one step beyond them along its sides: ab lies
/// beyond a as seen from b.
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
  std::int32_t classes[kHalf];  // of one width with the numbers: the loop stays in few registers
  for (int i = 0; i < count; ++i) {
    const W a = n.a[i], b = n.b[i], c = n.c[i], d = n.d[i];
    const W bends[8] = {n.ab[i] - 2 * a + b, n.ba[i] - 2 * b + a, n.cd[i] - 2 * c + d, n.dc[i] - 2 * d + c,
                        n.ac[i] - 2 * a + c, n.ca[i] - 2 * c + a, n.bd[i] - 2 * b + d, n.db[i] - 2 * d + b};
    W bend = 0, bent = 1;
    for (const W v : bends) bend += v, bent += size(v);
    // 22/64 of the four less 3/64 of the eight.
    predicted[i] = static_cast<W>(static_cast<Number>(16 * (a + b + c + d) - 3 * bend + 32) >> 6);
    // The highest bit of `bent` and the one below it, as a float has them.
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
  // Of one level: what is known, its centres, and the midpoints of sides along rows and along columns.
  W even[kGrid]{}, centres[kGrid]{};
  W predicted[2 * kHalf * kHalf]{};
  std::uint8_t contexts[2 * kHalf * kHalf]{};
  W numbers[2 * kHalf * kHalf]{};
  W sides[2 * kHalf * kHalf]{};  ///< those along rows, then those along columns
  std::uint8_t listed[2 * kHalf * kHalf]{};

  TALUS_CLONES static void predict_centres(Grids& g, int side) {
    extend<Number>(g.even, side);
    for (int row = 0; row < side; ++row) {
      const W *north = row_of(g.even, row - 1), *here = row_of(g.even, row), *south = row_of(g.even, row + 1),
              *beyond = row_of(g.even, row + 2);
      predict_row<Number>({here, here + 1, south, south + 1, here - 1, here + 2, south - 1, south + 2, north, beyond,
                           north + 1, beyond + 1},
                          side, g.predicted + row * side, g.contexts + row * side);
    }
  }
  TALUS_CLONES static void predict_sides(Grids& g, int side) {
    extend<Number>(g.centres, side);
    for (int row = 0; row < side; ++row) {
      const W *e0 = row_of(g.even, row - 1), *e1 = row_of(g.even, row), *e2 = row_of(g.even, row + 1);
      const W *c0 = row_of(g.centres, row - 1), *c1 = row_of(g.centres, row), *c2 = row_of(g.centres, row + 1);
      // Turned by 45 degrees: west, north / south, east.
      predict_row<Number>({e1, c0, c1, e1 + 1, c1 - 1, e0 + 1, e2, c0 + 1, c0 - 1, e2 + 1, e0, c1 + 1}, side,
                          g.predicted + row * side, g.contexts + row * side);
      predict_row<Number>({c1 - 1, e1, e2, c1, e2 - 1, c0, c2 - 1, e1 + 1, e1 - 1, c2, c0 - 1, e2 + 1}, side,
                          g.predicted + (side + row) * side, g.contexts + (side + row) * side);
    }
  }
  static W zigzag(W v) { return static_cast<W>(v << 1 ^ (0 - (v >> (8 * sizeof(W) - 1)))); }
  TALUS_CLONES static void subtract(Grids& g, int rows, int cols, const W* __restrict values, std::ptrdiff_t stride) {
    for (int row = 0; row < rows; ++row) {
      const W *predicted = g.predicted + row * cols, *from = values + row * stride;
      W* numbers = g.numbers + row * cols;
      for (int i = 0; i < cols; ++i) numbers[i] = zigzag(from[i] - predicted[i]);
    }
  }
  /// values = predicted + residual
  TALUS_CLONES static void add(const Grids& g, int rows, int cols, W* __restrict values, std::ptrdiff_t stride) {
    for (int row = 0; row < rows; ++row) {
      const W *predicted = g.predicted + row * cols, *numbers = g.numbers + row * cols;
      W* to = values + row * stride;
      for (int i = 0; i < cols; ++i) to[i] = predicted[i] + (numbers[i] >> 1 ^ (0 - (numbers[i] & 1)));
    }
  }
  /// All four kinds into one grid of twice the side; `to` may be that of the even ones.
  TALUS_CLONES static void join(const Grids& g, int side, W* to, std::ptrdiff_t stride) {
    for (int row = side; row-- > 0;) {  // from behind: nothing is overwritten before it is read
      W line[kHalf];
      std::copy_n(row_of(g.even, row), side, line);
      const W *along = g.sides + row * side, *down = g.sides + (side + row) * side, *centre = row_of(g.centres, row);
      W *upper = to + 2 * row * stride, *lower = upper + stride;
      for (int i = 0; i < side; ++i) upper[2 * i] = line[i], upper[2 * i + 1] = along[i];
      for (int i = 0; i < side; ++i) lower[2 * i] = down[i], lower[2 * i + 1] = centre[i];
    }
  }
};

/// Where the numbers of one kind stand in the square; of two kinds, the second follows row by row.
struct Part {
  std::size_t first, along, down;
  int side;
  std::size_t second = 0;
  [[nodiscard]] std::size_t at(int col, int row) const {
    const bool other = row >= side;
    return (other ? second : first) + static_cast<std::size_t>(col) * along +
           static_cast<std::size_t>(other ? row - side : row) * down;
  }
};

template <class Number>
HeightLevels<Number>::HeightLevels() : grids_(std::make_shared<Grids>()) {}

/// settle(part, kinds, values, stride) gives the numbers of a part their values, from the predictions and contexts.
template <class Number>
template <class Settle>
void HeightLevels<Number>::run(std::span<Number> square, Settle&& settle) {
  Grids& g = *grids_;
  constexpr std::size_t kRow = kPageSide;
  g.predicted[0] = 0;
  g.contexts[0] = kHeightContexts - 1;
  settle(Part{0, 0, 0, 1}, 1, row_of(g.even, 0), 0);
  for (int side = 1; side <= kHalf; side *= 2) {
    const std::size_t s = kRow / static_cast<std::size_t>(2 * side), twice = 2 * s;
    Grids::predict_centres(g, side);
    settle(Part{s * kRow + s, twice, twice * kRow, side}, 1, row_of(g.centres, 0), kStride);
    Grids::predict_sides(g, side);
    settle(Part{s, twice, twice * kRow, side, s * kRow}, 2, g.sides, side);
    if (side < kHalf) {
      Grids::join(g, side, row_of(g.even, 0), kStride);
    } else {
      Grids::join(g, side, reinterpret_cast<W*>(square.data()), kPageSide);
    }
  }
}

template <class Number>
void HeightLevels<Number>::put(std::span<Number> square, std::span<const std::uint8_t> coded, NumberWriter& out) {
  Grids& g = *grids_;
  run(square, [&](const Part& part, int parts, W* values, std::ptrdiff_t stride) {
    std::size_t i = 0, listed = 0;
    for (int row = 0; row < parts * part.side; ++row) {
      W* to = values + row * stride;
      const std::size_t from = part.at(0, row);
      const auto side = static_cast<std::size_t>(part.side);
      if (coded.empty()) {
        for (std::size_t col = 0; col < side; ++col) to[col] = static_cast<W>(square[from + col * part.along]);
      } else {
        for (std::size_t col = 0; col < side; ++col) {
          const bool is_coded = coded[from + col * part.along] != 0;
          to[col] = is_coded ? static_cast<W>(square[from + col * part.along]) : g.predicted[i + col];
          g.listed[listed] = g.contexts[i + col];
          g.numbers[listed] = Grids::zigzag(to[col] - g.predicted[i + col]);
          listed += is_coded ? 1 : 0;
        }
      }
      i += side;
    }
    if (coded.empty()) {
      Grids::subtract(g, parts * part.side, part.side, values, stride);
      out.put(g.numbers, std::span(g.contexts, i));
    } else {
      out.put(g.numbers, std::span(g.listed, listed));
    }
  });
}

template <class Number>
void HeightLevels<Number>::get(std::span<Number> square, std::span<const std::uint8_t> coded, NumberReader& in) {
  Grids& g = *grids_;
  run(square, [&](const Part& part, int parts, W* values, std::ptrdiff_t stride) {
    const std::size_t count = static_cast<std::size_t>(parts) * static_cast<std::size_t>(part.side * part.side);
    if (coded.empty()) {
      in.get(std::span(g.contexts, count), g.numbers);
    } else {
      std::size_t i = 0, listed = 0;
      for (int row = 0; row < parts * part.side; ++row) {
        for (int col = 0; col < part.side; ++col, ++i) {
          if (coded[part.at(col, row)] != 0) g.listed[listed++] = g.contexts[i];
        }
      }
      in.get(std::span(g.listed, listed), g.numbers);
      for (int row = parts * part.side; row-- > 0;) {  // from behind: each goes to its place without meeting another
        for (int col = part.side; col-- > 0;) g.numbers[--i] = coded[part.at(col, row)] != 0 ? g.numbers[--listed] : 0;
      }
    }
    Grids::add(g, parts * part.side, part.side, values, stride);
  });
}

template class HeightLevels<std::int32_t>;
template class HeightLevels<std::int64_t>;

}  // namespace talus
