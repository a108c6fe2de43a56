#pragma once
// What a question returns: a restricted quadtree, and the mesh that follows from it.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "talus/array.hpp"
#include "talus/description.hpp"
#include "talus/units.hpp"

namespace talus {

/// A set of grid points inside a rectangle: one bit a sample, row by row, and, once sealed, the rank
/// of each member in that order. The ranks are the vertex numbers of an answer. Threads: several may look, one change.
class VertexMask {
 public:
  VertexMask() = default;
  /// The empty set. Memory: one bit a sample of `region`, which the system hands out when touched.
  explicit VertexMask(GridRect region);

  [[nodiscard]] const GridRect& region() const { return region_; }
  [[nodiscard, gnu::always_inline]] bool contains(GridPoint p) const {  ///< p must lie in the region
    const auto [word, bit] = place(p);
    return (words_[word] >> bit & 1u) != 0;
  }
  void insert(GridPoint p) {
    const auto [word, bit] = place(p);
    words_[word] |= std::uint64_t{1} << bit;
  }
  /// A row's bits, for those who settle 64 samples at once: bit i of word w is column region().first.col + 64w + i.
  /// Bits beyond the last column must stay zero.
  [[nodiscard]] std::span<std::uint64_t> row_words(std::int32_t row) {
    return {words_.data() + place({region_.first.col, row}).word, words_per_row_};
  }
  [[nodiscard]] std::span<const std::uint64_t> row_words(std::int32_t row) const {
    return {words_.data() + place({region_.first.col, row}).word, words_per_row_};
  }
  /// Counts the members; `rank` and `size` hold from here until the next insert.
  void seal();
  [[nodiscard]] std::size_t size() const { return size_; }
  /// How many members stand before p, row by row. p itself need not be a member.
  [[nodiscard, gnu::always_inline]] std::uint32_t rank(GridPoint p) const {
    const auto [word, bit] = place(p);
    return before_[word] + static_cast<std::uint32_t>(std::popcount(words_[word] & ((std::uint64_t{1} << bit) - 1)));
  }
  /// The ranks of many points at once.
  void ranks(std::span<const GridPoint> points, std::span<std::uint32_t> out) const;
  /// Calls visit(GridPoint) for each member in rank order.
  template <class Visit>
  [[gnu::always_inline]] void for_each(Visit&& visit) const {
    for_each_in_rows(region_.first.row, region_.last.row, visit);
  }
  /// The same of some rows, the last included.
  template <class Visit>
  [[gnu::always_inline]] void for_each_in_rows(std::int32_t first, std::int32_t last, Visit&& visit) const {
    for (std::int64_t row = std::int64_t{first} - region_.first.row; row <= std::int64_t{last} - region_.first.row;
         ++row) {
      const std::size_t start = static_cast<std::size_t>(row) * words_per_row_;
      for (std::size_t w = 0; w < words_per_row_; ++w) {
        for (std::uint64_t rest = words_[start + w]; rest != 0; rest &= rest - 1) {
          const auto col = static_cast<std::int64_t>(w * 64) + std::countr_zero(rest);
          visit(GridPoint{static_cast<std::int32_t>(region_.first.col + col),
                          static_cast<std::int32_t>(region_.first.row + row)});
        }
      }
    }
  }

 private:
  struct Place {
    std::size_t word;
    unsigned bit;
  };
  [[nodiscard, gnu::always_inline]] Place place(GridPoint p) const {
    const auto col = static_cast<std::size_t>(std::int64_t{p.col} - region_.first.col);
    const auto row = static_cast<std::size_t>(std::int64_t{p.row} - region_.first.row);
    return {row * words_per_row_ + col / 64, static_cast<unsigned>(col % 64)};
  }
  GridRect region_{{0, 0}, {-1, -1}};
  std::size_t words_per_row_ = 0, size_ = 0;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;
};

/// Where an answer ends.
enum class Border {
  constrain,  ///< at the region's sides, which are mesh edges: answers at one tolerance meet there
  cover,      ///< behind it: all triangles of the whole raster's answer that meet the region, as they are
  clip        ///< those triangles, cut at the rectangle as it was asked for (see clip_mesh)
};

/// Where an answer comes from, and how its vertices were chosen.
struct Origin {
  Identity identity;
  Border border = Border::constrain;
  /// By a constrained border and one tolerance, and nothing else: what increments go on from.
  bool is_plain = false;
  /// Heights are the nearest multiples of this; 0: they are the source's own. Either way the bound holds for them.
  Metres quantum{0};
  friend bool operator==(const Origin&, const Origin&) = default;
};

/// A set of vertices closed under the dependency graph. It needs no stored topology: its
/// triangulation is unique and conforming. [P98 §3]
struct RestrictedQuadtree {
  /// That was answered: triangles that do not meet it are none of the answer. Empty: that of the vertices.
  GridRect region{{0, 0}, {-1, -1}};
  VertexMask vertices;    ///< over the region, or over all that its triangles need
  Array<double> heights;  ///< by rank, in the source's vertical unit
  /// By rank, four bits a vertex: which of the four triangles with this vertex at their right angle
  /// cover data (order: engine/quadtree/grid.hpp, `apex_triangles`). Empty when all do.
  std::vector<std::uint8_t> covers;
  Metres tolerance;  ///< as asked
  Metres bound;      ///< no valid sample under the surface is farther from it, along the vertical or as
      ///< Description::error_metric says; at most `tolerance` plus, where heights are no binary fractions, some
      ///< nanometres of rounding
  Origin origin;
  /// By log2 of the spacing, to that of the root square's side, which stands for root corners too: the largest error,
  /// in metres, of these vertices save those that the border needs; 0 where there is none. Without the levels finer
  /// than one, no sample under the surface is farther from it than the largest of theirs and `bound`. Empty: not known.
  std::vector<double> level_errors;
};

/// A place on the grid that need not be a sample.
struct Place {
  double col{}, row{};
  friend constexpr bool operator==(Place, Place) = default;
};

/// A rectangle of places.
struct Frame {
  double west{}, north{}, east{}, south{};
};

/// An indexed triangle mesh over grid points. Beside voids a point may be one: see Snapshot::ask.
struct Mesh {
  GridRect region;                                ///< the outermost sample positions answered
  Array<GridPoint> points;                        ///< each used by at least one triangle
  Array<double> heights;                          ///< of points, then of cuts, in the source's vertical unit
  Array<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from above
  std::vector<Place> cuts = {};                   ///< where clip_mesh cut edges: they count on behind `points`

  [[nodiscard]] std::size_t size() const { return points.size() + cuts.size(); }
  [[nodiscard]] Place place(std::size_t i) const {
    return i < points.size() ? Place{static_cast<double>(points[i].col), static_cast<double>(points[i].row)}
                             : cuts[i - points.size()];
  }
};

/// The triangles of a quadtree: no other triangulation fits its vertices, and it has no crack. A triangle is in the
/// mesh iff the vertex at its right angle is there and the midpoint of its longest side is not; so each vertex gives
/// those of its four triangles whose midpoint is absent. Vertex numbers are ranks in the mask. Triangles without data,
/// triangles that do not meet the region, and points that no triangle uses are left out.
///
/// threads  for large quadtrees; 0: one a core. The mesh does not depend on it
/// stop     ends the work within some rows
/// returns  triangles counter-clockwise seen from above (columns east, rows south)
/// fails    corrupt: vertices that are not closed under their parents, as damaged errors select; cancelled;
///          out_of_memory
/// cost     linear in vertices and triangles
/// source   [P98 §3]; without recursion: docs/architecture.md
[[nodiscard]] Mesh triangulate(const RestrictedQuadtree& quadtree, int threads = 0, const std::stop_token& stop = {});

}  // namespace talus
