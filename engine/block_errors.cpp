// Errors of the vertices whose spacing is below a block's side, the block's own centre excepted: its
// diagonal alternates from block to block, all other diamonds repeat.
//
// Where blocks are all data, eight neighbours go through together: their samples are transposed so that a
// vector holds the same cell of each, and every triangle of the pattern is evaluated once for all eight,
// with no shuffle and no mask. Float is exact for whole numbers while (heights · 2·side) stays within 24
// bits; other blocks go through in double. Blocks with voids or on the rim take the plain loop.

#include "engine/block_errors.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace talus::detail {
namespace {

constexpr int kLanes = 8;
constexpr int kSide = kBlockSide + 1;  // samples along a block

// Sixteen bytes are what every x86-64 has; the smaller-than of a vector extension would not become the one
// instruction it is there.
template <class Real>
struct Vector {
  typedef Real V __attribute__((vector_size(16)));
  static V max(V a, V b) {
#if defined(__SSE2__)
    if constexpr (sizeof(Real) == 4)
      return __builtin_ia32_maxps(a, b);
    else
      return __builtin_ia32_maxpd(a, b);
#else
    return a > b ? a : b;
#endif
  }
};

/// One number of each of eight blocks.
template <class Real>
struct Lanes {
  static constexpr int kWidth = 16 / sizeof(Real), kParts = kLanes / kWidth;
  typename Vector<Real>::V part[kParts]{};

  Real& operator[](int lane) { return reinterpret_cast<Real*>(part)[lane]; }
  Real operator[](int lane) const { return part[lane / kWidth][lane % kWidth]; }
  template <class Make>
  [[nodiscard]] static Lanes each(Make&& make) {
    Lanes made;
    for (int i = 0; i < kParts; ++i) made.part[i] = make(i);
    return made;
  }
  friend Lanes operator+(const Lanes& a, const Lanes& b) {
    return each([&](int i) { return a.part[i] + b.part[i]; });
  }
  friend Lanes operator-(const Lanes& a, const Lanes& b) {
    return each([&](int i) { return a.part[i] - b.part[i]; });
  }
  friend Lanes operator-(const Lanes& a) {
    return each([&](int i) { return -a.part[i]; });
  }
  friend Lanes operator*(const Lanes& a, Real b) {
    return each([&](int i) { return a.part[i] * b; });
  }
  friend Lanes larger(const Lanes& a, const Lanes& b) {
    return each([&](int i) { return Vector<Real>::max(a.part[i], b.part[i]); });
  }
};

/// The transposed samples of eight blocks, and the pattern of triangles over them.
template <class Real>
class BlockGroup {
  using V = Lanes<Real>;

 public:
  BlockGroup() : cells_(kSide * kSide) {}

  /// Blocks number `first` … in the row of blocks whose north-west sample is `corner`; fewer than eight
  /// repeat the last.
  void load(const HeightField& field, GridPoint corner, int count, double reference) {
    for (int row = 0; row < kSide; ++row) {
      const std::size_t start = field.index({corner.col, corner.row + row});
      std::visit(
          [&](auto heights) {
            for (int lane = 0; lane < kLanes; ++lane) {
              const auto* from = &heights[start] + std::min(lane, count - 1) * kBlockSide;
              for (int col = 0; col < kSide; ++col) {
                at(col, row)[lane] = static_cast<Real>(static_cast<double>(from[col]) - reference);
              }
            }
          },
          field.heights);
    }
  }

  /// Largest distance over the interior and the hypotenuse of both halves that lie in the block.
  [[nodiscard]] V error(GridPoint p) const {
    if (spacing(p) == 1) return finest(p);
    return is_centre(p) ? centre(p) : side_midpoint(p);
  }

 private:
  V& at(int col, int row) { return cells_[static_cast<std::size_t>(row * kSide + col)]; }
  [[nodiscard]] const V& at(int col, int row) const { return cells_[static_cast<std::size_t>(row * kSide + col)]; }
  [[nodiscard]] const V& at(GridPoint p) const { return at(p.col, p.row); }

  /// Distance to both sides of zero kept apart: no absolute value in the inner loop.
  struct Range {
    V above{}, below{};
    void take(const V& residual) {
      above = larger(above, residual);
      below = larger(below, -residual);
    }
    [[nodiscard]] V largest() const { return larger(above, below); }
  };

  [[nodiscard]] V finest(GridPoint p) const {
    const Diamond d = diamond(p);
    Range range;
    range.take(at(p) - (at(d.ends[0]) + at(d.ends[1])) * Real{0.5});
    return range.largest();
  }

  [[nodiscard]] V centre(GridPoint p) const {
    const Diamond d = diamond(p);
    const int s = spacing(p);
    Range range;
    for (std::size_t side = 0; side < 2; ++side) {
      const GridPoint apex = d.apexes[side];
      const int east = p.col > apex.col ? 1 : -1, south = p.row > apex.row ? 1 : -1;
      const V base = at(apex);
      const Real per_cell = Real{1} / static_cast<Real>(2 * s);  // a power of two: exact
      const V right = (at(apex.col + 2 * s * east, apex.row) - base) * (per_cell * static_cast<Real>(east));
      const V down = (at(apex.col, apex.row + 2 * s * south) - base) * (per_cell * static_cast<Real>(south));
      for (int v = 1; v < 2 * s; ++v) {
        const V start = base + down * static_cast<Real>(v * south);
        for (int u = 1; u <= 2 * s - v - static_cast<int>(side); ++u) {  // the hypotenuse once
          range.take(at(apex.col + u * east, apex.row + v * south) - (start + right * static_cast<Real>(u * east)));
        }
      }
    }
    return range.largest();
  }

  [[nodiscard]] V side_midpoint(GridPoint p) const {
    const Diamond d = diamond(p);
    const int s = spacing(p);
    const V a = at(d.ends[0]), b = at(d.ends[1]);
    const V mid = (a + b) * Real{0.5}, along = (b - a) * (Real{1} / static_cast<Real>(2 * s));
    const bool level = d.ends[0].row == d.ends[1].row;
    Range range;
    for (int t = 1 - s; t < s; ++t) {  // the hypotenuse
      const GridPoint q = level ? GridPoint{p.col + t, p.row} : GridPoint{p.col, p.row + t};
      range.take(at(q) - (mid + along * static_cast<Real>(t)));
    }
    for (const GridPoint apex : d.apexes) {
      if (apex.col < 0 || apex.row < 0 || apex.col >= kSide || apex.row >= kSide) continue;
      if (level) {
        const int south = apex.row > p.row ? 1 : -1;
        const V down = (at(apex) - mid) * (Real{1} / static_cast<Real>(s * south));
        for (int n = 1; n < s; ++n) {
          const V start = mid + down * static_cast<Real>(n * south);
          for (int t = n - s + 1; t < s - n; ++t) {
            range.take(at(p.col + t, p.row + n * south) - (start + along * static_cast<Real>(t)));
          }
        }
      } else {
        const int east = apex.col > p.col ? 1 : -1;
        const V right = (at(apex) - mid) * (Real{1} / static_cast<Real>(s * east));
        for (int t = 1 - s; t < s; ++t) {
          const V start = mid + along * static_cast<Real>(t);
          const int reach = s - (t < 0 ? -t : t);
          for (int n = 1; n < reach; ++n) {
            range.take(at(p.col + n * east, p.row + t) - (start + right * static_cast<Real>(n * east)));
          }
        }
      }
    }
    return range.largest();
  }

  std::vector<V> cells_;
};

/// The vertices of a block's closed square that are settled in it, in block coordinates.
std::vector<GridPoint> pattern() {
  std::vector<GridPoint> vertices;
  for (std::int32_t row = 0; row < kSide; ++row) {
    for (std::int32_t col = 0; col < kSide; ++col) {
      const GridPoint p{col, row};
      if (is_settled_in_block(p)) vertices.push_back(p);
    }
  }
  return vertices;
}

/// Distances of whole numbers are multiples of 1/64 in a block: the small ones are looked up.
class SmallCodes {
 public:
  explicit SmallCodes(const CodeDistance& distance) : distance_(distance), small_(kSmall) {
    for (std::size_t i = 0; i < kSmall; ++i)
      small_[i] = error_code(distance.metres(static_cast<double>(i) / kBlockSide));
  }
  [[nodiscard]] ErrorCode operator()(double distance) const {
    const double steps = distance * kBlockSide;
    if (steps < static_cast<double>(kSmall)) return small_[static_cast<std::size_t>(steps)];
    return error_code(distance_.metres(distance));
  }

 private:
  static constexpr std::size_t kSmall = 1 << 14;
  CodeDistance distance_;
  std::vector<ErrorCode> small_;
};

class BlockErrors {
 public:
  BlockErrors(const ErrorInput& input, LevelGrid<ErrorCode>& errors)
      : input_(input), field_(input.field), errors_(errors), codes_(input.field.distance), pattern_(pattern()) {}

  void run(GridRect blocks) {
    for (std::int32_t row = blocks.first.row; row <= blocks.last.row; ++row) {
      for (std::int32_t col = blocks.first.col; col <= blocks.last.col; ++col) {
        const GridPoint corner{col * kBlockSide, row * kBlockSide};
        int count = 0;
        while (count < kLanes && col + count <= blocks.last.col &&
               is_all_data({corner.col + count * kBlockSide, corner.row})) {
          ++count;
        }
        for (int i = 0; i < std::max(count, 1); ++i) {
          centre({corner.col + i * kBlockSide + kBlockSide / 2, corner.row + kBlockSide / 2});
        }
        if (count == 0) {
          plain(corner);
        } else {
          together(corner, count);
          col += count - 1;
        }
      }
    }
  }

 private:
  [[nodiscard]] bool is_all_data(GridPoint corner) const {
    if (!field_.extent.contains(corner) ||
        !field_.extent.contains({corner.col + kBlockSide, corner.row + kBlockSide})) {
      return false;
    }
    if (field_.valid.empty()) return true;
    for (std::int32_t row = corner.row; row <= corner.row + kBlockSide; ++row) {
      const auto* from = &field_.valid[field_.index({corner.col, row})];
      if (std::find(from, from + kSide, 0) != from + kSide) return false;
    }
    return true;
  }

  void plain(GridPoint corner) {
    const GridRect block{corner, {corner.col + kBlockSide, corner.row + kBlockSide}};
    for (const GridPoint q : pattern_) {
      const GridPoint p{corner.col + q.col, corner.row + q.row};
      double metres = 0;
      for (const int side : {0, 1}) {
        if (inside(half_diamond(p, side), block)) metres = std::max(metres, reference_half_error(input_, p, side));
      }
      if (metres > 0) errors_[p] = std::max(errors_[p], error_code(metres));
    }
  }
  void centre(GridPoint p) {
    if (!errors_.holds(p)) return;
    errors_[p] = error_code(std::max(reference_half_error(input_, p, 0), reference_half_error(input_, p, 1)));
  }

  void together(GridPoint corner, int count) {
    bool exact = true;
    for (int i = 0; i < count && input_.bits != nullptr; ++i) {
      const GridPoint block{(corner.col >> kBlockShift) + i, corner.row >> kBlockShift};
      exact = exact && (*input_.bits)[block].interpolates_exactly(kBlockSide);
    }
    if (exact) {
      evaluate(doubles_, corner, count, 0);
    } else {
      for (int i = 0; i < count; ++i) plain({corner.col + i * kBlockSide, corner.row});
    }
  }

  template <class Real>
  void evaluate(BlockGroup<Real>& group, GridPoint corner, int count, double reference) {
    group.load(field_, corner, count, reference);
    const bool whole = input_.bits == nullptr;
    for (const GridPoint q : pattern_) {
      const auto error = group.error(q);
      ErrorCode* code = &errors_[{corner.col + q.col, corner.row + q.row}];
      const int stride = kBlockSide / spacing(q);  // the same vertex of the next block
      for (int lane = 0; lane < count; ++lane, code += stride) {
        const auto distance = static_cast<double>(error[lane]);
        *code = std::max(*code, whole ? codes_(distance) : error_code(field_.distance.metres(distance)));
      }
    }
  }

  const ErrorInput& input_;
  const HeightField& field_;
  LevelGrid<ErrorCode>& errors_;
  SmallCodes codes_;
  std::vector<GridPoint> pattern_;
  BlockGroup<double> doubles_;
};

}  // namespace

void block_errors(const ErrorInput& input, GridRect blocks, LevelGrid<ErrorCode>& errors) {
  BlockErrors(input, errors).run(blocks);
}

}  // namespace talus::detail
