#pragma once
// RestrictedQuadtree, the result of a question, and the mesh that follows from it.

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

/// A set of samples of a rectangle: one bit a sample, row by row. seal() numbers the members in this order; the numbers
/// (ranks) are the vertex numbers of an answer. Threads: any number may read, one may change.
class VertexMask {
 public:
  VertexMask() = default;
  /// The empty set. Memory: one bit a sample of `region`; the system provides it when it is first written.
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
  /// Inserts all members of a mask of the same region.
  /// fails  invalid_argument: of another region
  void insert(const VertexMask& other);
  /// The bits of one row: bit i of word w is column region().first.col + 64w + i. Bits beyond the last column are 0.
  [[nodiscard]] std::span<std::uint64_t> row_words(std::int32_t row) {
    return {words_.data() + place({region_.first.col, row}).word, words_per_row_};
  }
  [[nodiscard]] std::span<const std::uint64_t> row_words(std::int32_t row) const {
    return {words_.data() + place({region_.first.col, row}).word, words_per_row_};
  }
  /// Numbers the members. `rank` and `size` are valid from here until the next insert.
  void seal();
  [[nodiscard]] std::size_t size() const { return size_; }
  /// The number of members before p, row by row. p may be any point of the region.
  [[nodiscard, gnu::always_inline]] std::uint32_t rank(GridPoint p) const {
    const auto [word, bit] = place(p);
    return before_[word] + static_cast<std::uint32_t>(std::popcount(words_[word] & ((std::uint64_t{1} << bit) - 1)));
  }
  /// The rank of the first bit of each word of a row. The words and these numbers of one row follow those of the row
  /// before it in memory.
  [[nodiscard]] std::span<const std::uint32_t> row_ranks(std::int32_t row) const {
    return {before_.data() + place({region_.first.col, row}).word, words_per_row_};
  }
  /// The ranks of many points.
  void ranks(std::span<const GridPoint> points, std::span<std::uint32_t> out) const;
  /// Calls visit(GridPoint) for each member in rank order.
  template <class Visit>
  [[gnu::always_inline]] void for_each(Visit&& visit) const {
    for_each_in_rows(region_.first.row, region_.last.row, visit);
  }
  /// The same for rows `first` to `last`, both included.
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
  constrain,  ///< at the sides of the region, which are mesh edges; answers at one tolerance meet there
  cover,      ///< outside: it has every triangle of the whole raster's answer that meets the region
  clip        ///< as `cover`; then call clip_mesh with PlacedRectangle::frame, which cuts at the rectangle
};

/// Which database an answer comes from, and how its vertices were chosen.
struct Origin {
  Identity identity;
  Border border = Border::constrain;
  /// Chosen by one tolerance and a constrained border only. Increments can follow such an answer.
  bool is_plain = false;
  /// Heights are multiples of this; 0: they are the source's own. The bound holds for these heights.
  Metres quantum{0};
  friend bool operator==(const Origin&, const Origin&) = default;
};

/// A set of vertices that holds the parents of each. Exactly one triangulation fits it, without cracks. [P98 §3]
struct RestrictedQuadtree {
  /// The region that was asked for: triangles outside are not part of the answer. Empty: the region of `vertices`.
  GridRect region{{0, 0}, {-1, -1}};
  VertexMask vertices;    ///< over the region, or over everything that its triangles need
  Array<double> heights;  ///< by rank, in the source's vertical unit
  /// Four bits a vertex, by rank: which of the four triangles with their right angle at this vertex hold data. Empty:
  /// all of them. Let s be the lowest set bit of col | row. If only col has it, bits 0 to 3 are the triangles to the
  /// north-west, north-east, south-west, south-east (a corner each: s to the north or south, and s to the west or
  /// east). If only row has it: north-west, south-west, north-east, south-east. If both have it, the square of side 2s
  /// around the vertex is cut into four: where (col − s) and (row − s) have the same bit 2s, bits 0 to 3 are its north,
  /// east, west and south quarter; elsewhere its north, west, east and south quarter.
  std::vector<std::uint8_t> covers;
  Metres tolerance;  ///< as asked
  /// No valid sample under the surface is farther from it, in the direction of Description::error_metric. It is at most
  /// `tolerance`, plus some nanometres where heights are not binary fractions.
  Metres bound;
  Origin origin;
  /// The largest error in metres of the vertices of one spacing, without those that the border needs; by log2 of the
  /// spacing, up to the root square's side (root corners included). 0: no such vertex. If the finest levels are left
  /// out, the bound is the largest of theirs and `bound`. Empty: not known.
  std::vector<double> level_errors;
};

/// A point in grid coordinates, also between samples.
struct Place {
  double col{}, row{};
  friend constexpr bool operator==(Place, Place) = default;
};

/// A rectangle in grid coordinates.
struct Frame {
  double west{}, north{}, east{}, south{};
};

/// An indexed triangle mesh. Beside voids a point may be void: see Snapshot::ask.
struct Mesh {
  GridRect region;                                ///< the samples of the answer
  Array<GridPoint> points;                        ///< each belongs to at least one triangle
  Array<double> heights;                          ///< of `points`, then of `cuts`, in the source's vertical unit
  Array<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from above
  std::vector<Place> cuts = {};                   ///< where clip_mesh cut edges; numbered after `points`

  [[nodiscard]] std::size_t size() const { return points.size() + cuts.size(); }
  [[nodiscard]] Place place(std::size_t i) const {
    return i < points.size() ? Place{static_cast<double>(points[i].col), static_cast<double>(points[i].row)}
                             : cuts[i - points.size()];
  }
};

/// The triangles of a quadtree. Exactly one triangulation fits its vertices, and it has no cracks: a triangle is in it
/// if the vertex at its right angle is there and the midpoint of its longest side is not. Left out: triangles without
/// data or outside the region, and points without a triangle. A vertex's number is its rank.
///
/// threads  for large quadtrees; 0: one a core. The mesh does not depend on it
/// stop     ends the work within some rows
/// returns  triangles counter-clockwise seen from above (columns east, rows south). Their order depends on the quadtree
///          alone
/// fails    corrupt: a vertex without its parents: an increment, which must be merged first, or damaged errors;
///          cancelled; out_of_memory
/// cost     linear in vertices and triangles
/// source   [P98 §3]; without recursion: docs/architecture.md
[[nodiscard]] Mesh triangulate(const RestrictedQuadtree& quadtree, int threads = 0, const std::stop_token& stop = {});
/// The same, in the memory of a mesh that is no longer needed. The first write to new memory takes longer than the
/// triangulation.
///
/// into   any mesh; becomes the result. After a failure nothing is known of it
void triangulate(const RestrictedQuadtree& quadtree, Mesh& into, int threads = 0, const std::stop_token& stop = {});

}  // namespace talus
