#pragma once
// Adds a level of half the spacing to the vertices of coarser levels: which grid points may be vertices, the predicted
// height of each, and the heights of the vertices. Writers and readers use the same walk. A coder says which candidates
// are vertices: it knows the answer, or reads the stream. [P98 §3; docs/format/rqt-v1.md, sections 5 and 6]
//
// A grid point is a strict candidate if all corners of its diamond in the window are vertices. Other points may be
// vertices only amid voids and outside a region. There, a point with one parent is a loose candidate. All others must
// be known beforehand. A level has two halves: centres, then side midpoints. A prediction depends on earlier halves
// only, so the rows of a half may be walked in any order and by several threads.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "engine/stream/bit_lattice.hpp"
#include "talus/array.hpp"
#include "talus/failure.hpp"

namespace talus {

/// Contexts of strict candidates. They differ in the kind of vertex, the size of the parents' residuals, and the
/// distance between the two predictions.
inline constexpr int kEnergies = 4, kDistances = 4;
inline constexpr int kStrictContexts = 2 * kEnergies * kDistances;
/// Two more contexts are for loose centres and loose side midpoints.
inline constexpr int kCandidateContexts = kStrictContexts + 2;

/// The mean of two codes, rounded down, without overflow.
template <class Code>
[[nodiscard]] constexpr Code halfway(Code a, Code b) {
  return static_cast<Code>((a & b) + ((a ^ b) >> 1));
}

/// a − b, which wraps around.
template <class Code>
[[nodiscard]] constexpr Code wrapped_difference(Code a, Code b) {
  using Word = std::make_unsigned_t<Code>;
  return static_cast<Code>(static_cast<Word>(a) - static_cast<Word>(b));
}
template <class Code>
[[nodiscard]] constexpr Code wrapped_sum(Code a, Code b) {
  using Word = std::make_unsigned_t<Code>;
  return static_cast<Code>(static_cast<Word>(a) + static_cast<Word>(b));
}

/// Measures residuals in eighths of the tolerance, at most 255.
class Scale {
 public:
  /// tolerance  in height codes
  explicit Scale(double tolerance) : factor_(static_cast<float>(8.0 / std::clamp(tolerance, 1.0, 1e9))) {}
  template <class Code>
  [[nodiscard]] std::uint8_t of(Code residual) const {
    return size(residual, factor_);
  }
  [[nodiscard]] float factor() const { return factor_; }
  template <class Code>
  [[nodiscard, gnu::always_inline]] static std::uint8_t size(Code residual, float factor) {
    const float size = static_cast<float>(residual < 0 ? ~residual : residual) * factor;
    return static_cast<std::uint8_t>(static_cast<int>(size < 255.0f ? size : 255.0f));
  }

 private:
  float factor_;
};

/// Arrays of many candidates, for vector instructions.
template <class Code>
struct Expectations {
  std::size_t count = 0;
  const Code *end1 = nullptr, *end2 = nullptr, *beside1 = nullptr, *beside2 = nullptr;
  const std::uint8_t *size1 = nullptr, *size2 = nullptr;  ///< residual sizes of the vertices beside
  Code *predicted = nullptr, *flips = nullptr;
  std::uint8_t* contexts = nullptr;
};
/// Predicts strict candidates: the middle between the ends of the diamond. `flips` are set if the vertices beside lie
/// lower, because the residual is then likely to be negative.
void expect_all(const Expectations<std::int32_t>& candidates, float scale, int kind);
void expect_all(const Expectations<std::int64_t>& candidates, float scale, int kind);
/// Computes the heights and residual sizes of candidates from their residuals.
void settle_all(std::size_t count, const std::int32_t* predicted, const std::int32_t* flips,
                const std::int32_t* residuals, float scale, std::int32_t* heights, std::uint8_t* sizes);
void settle_all(std::size_t count, const std::int64_t* predicted, const std::int64_t* flips,
                const std::int64_t* residuals, float scale, std::int64_t* heights, std::uint8_t* sizes);

/// The vertices of a level and all coarser levels, row by row.
template <class Code>
struct LevelVertices {
  BitLattice bits;
  std::vector<std::size_t> row_start;  ///< index in `heights` of each row's first vertex, and of the end
  Array<Code> heights;
  Array<std::uint8_t> sizes;  ///< sizes of their residuals, see Scale
};

/// Vertices of one half of a level that are known before it is coded, row by row.
template <class Code>
struct KnownVertices {
  std::vector<GridPoint> points;
  std::vector<Code> heights;
};

/// The candidates of a row: first the strict ones from the west, then the loose ones. Arrays have `count` elements.
template <class Code>
struct CandidateRow {
  std::int32_t row = 0;  ///< row of the level's lattice
  std::size_t count = 0;
  const std::uint32_t* columns = nullptr;
  const std::uint8_t* contexts = nullptr;
  const Code* predicted = nullptr;
  const Code* flips = nullptr;      ///< all bits set if the residual is likely to be negative
  std::uint8_t* present = nullptr;  ///< filled by the coder: 1 for a vertex
  Code* residuals = nullptr;        ///< filled by the coder: code − predicted, inverted if `flips` is set
};

template <class Code>
class LevelWalk {
 public:
  /// window  rectangle of all vertices
  /// coarse  the vertices down to twice the spacing
  /// most    number of vertices that the writer promised; more are corrupt
  LevelWalk(GridRect window, const LevelVertices<Code>& coarse, Scale scale, bool has_loose, std::size_t most)
      : window_(window), coarse_(coarse), scale_(scale), has_loose_(has_loose), most_(most) {
    fine_.bits = BitLattice(window, coarse.bits.shift - 1);
    centres_.bits = fine_.bits;
  }
  [[nodiscard]] std::int32_t rows() const { return fine_.bits.rows; }

  struct WalkedRows {
    Array<Code> heights;
    Array<std::uint8_t> sizes;
    std::vector<std::size_t> row_sizes;
  };

  /// Walks the centres of some rows. coder(CandidateRow&) fills in each row, from the north.
  template <class Coder>
  [[nodiscard]] WalkedRows centres(std::int32_t first, std::int32_t last, const KnownVertices<Code>& known,
                                   Coder&& coder) {
    return walk<true>(first, last, known, coder);
  }
  /// Joins the parts of the centres, from the north.
  void take_centres(std::vector<WalkedRows>&& parts) { join(centres_, std::move(parts)); }
  /// Walks the side midpoints of some rows. The result has all vertices of these rows.
  template <class Coder>
  [[nodiscard]] WalkedRows sides(std::int32_t first, std::int32_t last, const KnownVertices<Code>& known,
                                 Coder&& coder) {
    return walk<false>(first, last, known, coder);
  }
  void take_all(std::vector<WalkedRows>&& parts) { join(fine_, std::move(parts)); }
  [[nodiscard]] const BitLattice& centre_bits() const { return centres_.bits; }
  [[nodiscard]] const BitLattice& bits() const { return fine_.bits; }
  [[nodiscard]] LevelVertices<Code> take_vertices() { return std::move(fine_); }

 private:
  /// A row of the lattice, with a margin. heights: by column; the number at a column without a vertex means nothing.
  struct Row {
    std::vector<std::uint64_t> bits;  // with a word of zeros at both ends
    std::vector<Code> heights;        // with 64 unused heights at both ends
    std::vector<std::uint8_t> sizes;
    explicit Row(std::size_t words) : bits(words + 2), heights((words + 2) * 64), sizes((words + 2) * 64) {}
    [[nodiscard]] std::uint64_t* words() { return bits.data() + 1; }
    [[nodiscard]] Code* height() { return heights.data() + 64; }
    [[nodiscard]] std::uint8_t* size() { return sizes.data() + 64; }
    [[nodiscard]] bool has(std::int64_t i) const {
      return (bits[static_cast<std::size_t>(i + 64) / 64] >> (static_cast<std::size_t>(i + 64) % 64) & 1u) != 0;
    }
  };
  // Bit i of the result is column i − 1 (west) or i + 1 (east).
  static std::uint64_t west(const std::uint64_t* b) { return b[0] << 1 | b[-1] >> 63; }
  static std::uint64_t east(const std::uint64_t* b) { return b[0] >> 1 | b[1] << 63; }

  [[nodiscard]] bool is_odd(std::int32_t j) const { return ((fine_.bits.first_row + j) & 1) != 0; }

  void load(Row& row, std::int32_t j, bool with_centres) const {
    const BitLattice& f = fine_.bits;
    std::fill(row.bits.begin(), row.bits.end(), 0);
    if (j < 0 || j >= f.rows) return;
    if (is_odd(j)) {
      if (with_centres) copy(row, centres_, j);
      return;
    }
    const BitLattice& c = coarse_.bits;
    const std::int32_t from = ((f.first_row + j) >> 1) - c.first_row;
    const std::uint64_t* words = c.row(from);
    const unsigned odd = f.starts_odd();
    const Code* height = coarse_.heights.data() + coarse_.row_start[static_cast<std::size_t>(from)];
    const std::uint8_t* size = coarse_.sizes.data() + coarse_.row_start[static_cast<std::size_t>(from)];
    for (std::size_t w = 0; w < c.words_per_row; ++w) {
      std::uint64_t rest = words[w];
      row.words()[2 * w] = spread_bits(rest) << odd;
      if (2 * w + 1 < f.words_per_row) row.words()[2 * w + 1] = spread_bits(rest >> 32) << odd;
      Code* to = row.height() + 128 * w + odd;
      std::uint8_t* to_size = row.size() + 128 * w + odd;
      for (; rest != 0; rest &= rest - 1) {
        const int i = 2 * std::countr_zero(rest);
        to[i] = *height++;
        to_size[i] = *size++;
      }
    }
  }

  static void copy(Row& row, const LevelVertices<Code>& from, std::int32_t j) {
    const std::uint64_t* words = from.bits.row(j);
    const Code* height = from.heights.data() + from.row_start[static_cast<std::size_t>(j)];
    const std::uint8_t* size = from.sizes.data() + from.row_start[static_cast<std::size_t>(j)];
    for (std::size_t w = 0; w < from.bits.words_per_row; ++w) {
      std::uint64_t rest = words[w];
      row.words()[w] = rest;
      for (; rest != 0; rest &= rest - 1) {
        const auto i = 64 * w + static_cast<std::size_t>(std::countr_zero(rest));
        row.height()[i] = *height++;
        row.size()[i] = *size++;
      }
    }
  }

  /// Which columns of a row are candidates or known vertices, as bits.
  struct RowBits {
    std::vector<std::uint64_t> strict, loose, known;
    explicit RowBits(std::size_t words) : strict(words), loose(words), known(words) {}
  };

  /// The bits of word w that are columns of the lattice.
  [[nodiscard]] std::uint64_t inside(std::size_t w) const {
    const int left = fine_.bits.cols - static_cast<std::int32_t>(64 * w);
    return left >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
  }

  void find_centres(RowBits& bits, std::int32_t j, Row& above, Row& below) const {
    const BitLattice& f = fine_.bits;
    // A centre lies in a square of the coarser lattice. If column + row is even, apexes are north-east and south-west.
    const int row_parity = ((f.first_row + j) >> 1) & 1;
    std::uint64_t even_squares = 0;  // centres whose square has an even column
    for (int i = 0; i < 64; ++i) even_squares |= ((f.first_col + i) & 3) == 1 ? std::uint64_t{1} << i : 0;
    const std::uint64_t odd_squares = even_squares << 2 | even_squares >> 62;
    const std::uint64_t same = row_parity == 0 ? even_squares : odd_squares, other = even_squares ^ odd_squares ^ same;
    for (std::size_t w = 0; w < f.words_per_row; ++w) {
      const std::uint64_t *u = above.words() + w, *d = below.words() + w;
      const std::uint64_t nw = west(u), ne = east(u), sw = west(d), se = east(d);
      bits.strict[w] = nw & ne & sw & se & ~bits.known[w];
      if (has_loose_) {
        const std::uint64_t any = ((ne | sw) & same) | ((nw | se) & other);
        bits.loose[w] = any & inside(w) & ~bits.strict[w] & ~bits.known[w];
      }
    }
  }

  void find_sides(RowBits& bits, std::int32_t j, Row& above, Row& row, Row& below) const {
    const BitLattice& f = fine_.bits;
    const std::uint64_t odd_columns = f.starts_odd() != 0 ? 0x5555555555555555u : 0xaaaaaaaaaaaaaaaau;
    const bool is_vertical = is_odd(j);
    const bool first_row = f.at(0, j).row == window_.first.row, last_row = f.at(0, j).row == window_.last.row;
    for (std::size_t w = 0; w < f.words_per_row; ++w) {
      const std::uint64_t *u = above.words() + w, *b = row.words() + w, *d = below.words() + w;
      std::uint64_t ends, one, two, real, columns;
      if (is_vertical) {
        columns = ~odd_columns;
        ends = u[0] & d[0];
        one = west(b), two = east(b);
        real = one | two;
        if (w == 0 && f.at(0, 0).col == window_.first.col) one |= 1;
        const std::int32_t last = f.cols - 1;
        if (static_cast<std::size_t>(last) / 64 == w && f.at(last, 0).col == window_.last.col)
          two |= std::uint64_t{1} << (last % 64);
      } else {
        columns = odd_columns;
        ends = west(b) & east(b);
        one = u[0], two = d[0];
        real = one | two;
        if (first_row) one = ~std::uint64_t{0};
        if (last_row) two = ~std::uint64_t{0};
      }
      // `real`: a window of one row or column has no triangles and no strict candidates.
      bits.strict[w] = ends & one & two & real & columns & ~bits.known[w];
      if (has_loose_) bits.loose[w] = real & columns & inside(w) & ~bits.strict[w] & ~bits.known[w];
    }
  }

  struct Room {
    std::vector<std::uint32_t> columns;
    std::vector<std::uint8_t> contexts, present, size1, size2, sizes;
    std::vector<Code> end1, end2, beside1, beside2, predicted, flips, residuals, heights;
    explicit Room(std::size_t n)
        : columns(n),
          contexts(n),
          present(n),
          size1(n),
          size2(n),
          sizes(n),
          end1(n),
          end2(n),
          beside1(n),
          beside2(n),
          predicted(n),
          flips(n),
          residuals(n),
          heights(n) {}
    /// Adds a strict candidate: its column, the heights of both ends and of both vertices beside.
    [[gnu::always_inline]] void put(std::size_t n, std::size_t i, Code a, Code b, Code c, Code d, std::uint8_t size_c,
                                    std::uint8_t size_d) {
      columns[n] = static_cast<std::uint32_t>(i);
      end1[n] = a, end2[n] = b, beside1[n] = c, beside2[n] = d;
      size1[n] = size_c, size2[n] = size_d;
    }
  };

  /// Predicts a loose candidate from the corners of its diamond that are vertices.
  void expect_loose(Room& room, std::size_t n, std::size_t i, std::int32_t j, Row& above, Row& row, Row& below,
                    int kind) const {
    Code predicted = 0;
    for (const auto& [one, two] : {apexes(i, j, kind, above, row, below), ends(i, j, kind, above, row, below)}) {
      const auto [p, a] = one;
      const auto [q, b] = two;
      if (p->has(a) && q->has(b)) {
        predicted = halfway(p->height()[a], q->height()[b]);
      } else if (p->has(a)) {
        predicted = p->height()[a];
      } else if (q->has(b)) {
        predicted = q->height()[b];
      }
    }
    room.columns[n] = static_cast<std::uint32_t>(i);
    room.predicted[n] = predicted;
    room.flips[n] = 0;
    room.contexts[n] = static_cast<std::uint8_t>(kStrictContexts + kind);
  }

  template <bool are_centres, class Coder>
  WalkedRows walk(std::int32_t first, std::int32_t last, const KnownVertices<Code>& known, Coder&& coder) {
    const BitLattice& f = fine_.bits;
    const std::size_t words = f.words_per_row;
    WalkedRows part;
    part.row_sizes.reserve(static_cast<std::size_t>(last - first));
    Row one(words), two(words), three(words);
    Row *above = &one, *row = &two, *below = &three;
    RowBits bits(words);
    Room room(64 * words);
    load(*above, first - 1, !are_centres);
    load(*row, first, !are_centres);
    const auto row_of = [&](std::size_t k) { return (known.points[k].row >> f.shift) - f.first_row; };
    std::size_t next = 0;
    while (next < known.points.size() && row_of(next) < first) ++next;
    for (std::int32_t j = first; j < last; ++j) {
      load(*below, j + 1, !are_centres);
      const std::size_t known_first = next;
      for (; next < known.points.size() && row_of(next) == j; ++next) {
        const auto i = static_cast<std::size_t>((known.points[next].col >> f.shift) - f.first_col);
        bits.known[i / 64] |= std::uint64_t{1} << (i % 64);
      }
      if (!are_centres || is_odd(j)) {
        if constexpr (are_centres) {
          find_centres(bits, j, *above, *below);
        } else {
          mirror_border(*above, *row, *below, j);
          find_sides(bits, j, *above, *row, *below);
        }
        visit<are_centres>(bits, room, j, *above, *row, *below, coder);
      }
      for (std::size_t k = known_first; k < next; ++k) {
        const auto i = static_cast<std::size_t>((known.points[k].col >> f.shift) - f.first_col);
        row->words()[i / 64] |= std::uint64_t{1} << (i % 64);
        row->height()[i] = known.heights[k];
        row->size()[i] = size_of_known<are_centres>(i, j, known.heights[k], *above, *row, *below);
        bits.known[i / 64] = 0;
      }
      if (!are_centres || is_odd(j)) {
        append(part, *row, (are_centres ? centres_ : fine_).bits.row(j));
      } else {
        part.row_sizes.push_back(0);
      }
      Row* const free = above;
      above = row, row = below, below = free;
    }
    return part;
  }

  /// The residual size of a known vertex; 8, which is the tolerance, if an end of its diamond is missing.
  template <bool are_centres>
  [[nodiscard]] std::uint8_t size_of_known(std::size_t i, std::int32_t j, Code height, Row& above, Row& row,
                                           Row& below) const {
    const auto [one, two] = ends(i, j, are_centres ? 0 : 1, above, row, below);
    if (!one.first->has(one.second) || !two.first->has(two.second)) return 8;
    return scale_.of(
        wrapped_difference(height, halfway(one.first->height()[one.second], two.first->height()[two.second])));
  }

  /// The row and column of a corner of a vertex's diamond.
  using Stand = std::pair<Row*, std::int64_t>;
  [[nodiscard]] std::pair<Stand, Stand> ends(std::size_t i, std::int32_t j, int kind, Row& above, Row& row,
                                             Row& below) const {
    const auto here = static_cast<std::int64_t>(i);
    if (kind == 0) {
      const bool even = is_even_square(i, j);
      return {{&above, even ? here - 1 : here + 1}, {&below, even ? here + 1 : here - 1}};
    }
    if (is_odd(j)) return {{&above, here}, {&below, here}};
    return {{&row, here - 1}, {&row, here + 1}};
  }
  [[nodiscard]] std::pair<Stand, Stand> apexes(std::size_t i, std::int32_t j, int kind, Row& above, Row& row,
                                               Row& below) const {
    const auto here = static_cast<std::int64_t>(i);
    if (kind == 0) {
      const bool even = is_even_square(i, j);
      return {{&above, even ? here + 1 : here - 1}, {&below, even ? here - 1 : here + 1}};
    }
    if (is_odd(j)) return {{&row, here - 1}, {&row, here + 1}};
    return {{&above, here}, {&below, here}};
  }
  [[nodiscard]] bool is_even_square(std::size_t i, std::int32_t j) const {
    return ((((fine_.bits.first_col + static_cast<std::int32_t>(i)) >> 1) ^ ((fine_.bits.first_row + j) >> 1)) & 1) ==
           0;
  }

  /// Copies the inner vertex beside to the outer place, on the sides of the window.
  void mirror_border(Row& above, Row& row, Row& below, std::int32_t j) const {
    const BitLattice& f = fine_.bits;
    if (is_odd(j)) {
      if (f.cols < 2) return;
      row.height()[-1] = row.height()[1];
      row.size()[-1] = row.size()[1];
      const std::int32_t last = f.cols - 1;
      row.height()[last + 1] = row.height()[last - 1];
      row.size()[last + 1] = row.size()[last - 1];
      return;
    }
    if (f.at(0, j).row == window_.first.row) above.heights = below.heights, above.sizes = below.sizes;
    if (f.at(0, j).row == window_.last.row) below.heights = above.heights, below.sizes = above.sizes;
  }

  template <bool are_centres, class Coder>
  void visit(const RowBits& bits, Room& room, std::int32_t j, Row& above, Row& row, Row& below, Coder&& coder) {
    const BitLattice& f = fine_.bits;
    std::size_t n = 0;
    for (std::size_t w = 0; w < f.words_per_row; ++w) {
      for (std::uint64_t rest = bits.strict[w]; rest != 0; rest &= rest - 1) {
        const std::size_t i = 64 * w + static_cast<std::size_t>(std::countr_zero(rest));
        const Code *u = above.height() + i, *b = row.height() + i, *d = below.height() + i;
        const std::uint8_t *us = above.size() + i, *bs = row.size() + i, *ds = below.size() + i;
        if constexpr (are_centres) {
          if (is_even_square(i, j)) {
            room.put(n++, i, u[-1], d[1], u[1], d[-1], us[1], ds[-1]);
          } else {
            room.put(n++, i, u[1], d[-1], u[-1], d[1], us[-1], ds[1]);
          }
        } else if (is_odd(j)) {
          room.put(n++, i, *u, *d, b[-1], b[1], bs[-1], bs[1]);
        } else {
          room.put(n++, i, b[-1], b[1], *u, *d, *us, *ds);
        }
      }
    }
    expect_all({n, room.end1.data(), room.end2.data(), room.beside1.data(), room.beside2.data(), room.size1.data(),
                room.size2.data(), room.predicted.data(), room.flips.data(), room.contexts.data()},
               scale_.factor(), are_centres ? 0 : 1);
    if (has_loose_) {
      for (std::size_t w = 0; w < f.words_per_row; ++w) {
        for (std::uint64_t rest = bits.loose[w]; rest != 0; rest &= rest - 1)
          expect_loose(room, n++, 64 * w + static_cast<std::size_t>(std::countr_zero(rest)), j, above, row, below,
                       are_centres ? 0 : 1);
      }
    }
    if (n == 0) return;
    CandidateRow<Code> candidates{j,
                                  n,
                                  room.columns.data(),
                                  room.contexts.data(),
                                  room.predicted.data(),
                                  room.flips.data(),
                                  room.present.data(),
                                  room.residuals.data()};
    coder(candidates);
    settle_all(n, room.predicted.data(), room.flips.data(), room.residuals.data(), scale_.factor(), room.heights.data(),
               room.sizes.data());
    std::size_t k = 0;
    for (const auto* words : {&bits.strict, &bits.loose}) {
      if (words == &bits.loose && !has_loose_) break;
      for (std::size_t w = 0; w < f.words_per_row; ++w) {
        std::uint64_t there = 0;
        Code* height = row.height() + 64 * w;
        std::uint8_t* size = row.size() + 64 * w;
        for (std::uint64_t rest = (*words)[w]; rest != 0; rest &= rest - 1, ++k) {
          const int i = std::countr_zero(rest);
          there |= static_cast<std::uint64_t>(room.present[k]) << i;
          height[i] = room.heights[k];
          size[i] = room.sizes[k];
        }
        row.words()[w] |= there;
      }
    }
  }

  void append(WalkedRows& part, Row& row, std::uint64_t* out) const {
    const std::size_t words = fine_.bits.words_per_row, begin = part.heights.size(), room = begin + 64 * words;
    if (part.heights.capacity() < room) {
      part.heights.reserve(2 * begin + room + 4096);
      part.sizes.reserve(2 * begin + room + 4096);
    }
    part.heights.resize(room);
    part.sizes.resize(room);
    Code* height = part.heights.data() + begin;
    std::uint8_t* size = part.sizes.data() + begin;
    for (std::size_t w = 0; w < words; ++w) {
      out[w] = row.words()[w];
      const Code* from = row.height() + 64 * w;
      const std::uint8_t* from_size = row.size() + 64 * w;
      for (std::uint64_t rest = out[w]; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        *height++ = from[i];
        *size++ = from_size[i];
      }
    }
    const auto count = static_cast<std::size_t>(height - part.heights.data());
    if (count > most_) throw Failure(Cause::corrupt, "corrupt: a part has more vertices than it says");
    part.heights.resize(count);
    part.sizes.resize(count);
    part.row_sizes.push_back(count - begin);
  }

  static void join(LevelVertices<Code>& whole, std::vector<WalkedRows>&& parts) {
    whole.row_start = {0};
    whole.heights.clear(), whole.sizes.clear();
    for (const WalkedRows& part : parts) {
      for (const std::size_t size : part.row_sizes) whole.row_start.push_back(whole.row_start.back() + size);
    }
    if (parts.size() == 1) {
      whole.heights = std::move(parts[0].heights);
      whole.sizes = std::move(parts[0].sizes);
      return;
    }
    whole.heights.reserve(whole.row_start.back());
    whole.sizes.reserve(whole.row_start.back());
    for (const WalkedRows& part : parts) {
      whole.heights.insert(whole.heights.end(), part.heights.begin(), part.heights.end());
      whole.sizes.insert(whole.sizes.end(), part.sizes.begin(), part.sizes.end());
    }
  }

  GridRect window_;
  const LevelVertices<Code>& coarse_;
  Scale scale_;
  bool has_loose_;
  std::size_t most_;
  LevelVertices<Code> centres_, fine_;
};

}  // namespace talus
