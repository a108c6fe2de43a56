#include "engine/quadtree/triangulation_by_words.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "engine/machine/instruction_set.hpp"
#include "engine/machine/parallel.hpp"
#include "engine/quadtree/leaves.hpp"
#include "engine/quadtree/triangle_kernel.hpp"

namespace talus::detail {

extern const TriangleKernel portable_triangle_kernel, avx2_triangle_kernel, avx512_triangle_kernel;

namespace {

constexpr std::int64_t kRowsAtOnce = 256;  ///< between two checks of the stop token

const TriangleKernel& triangle_kernel() {
  const InstructionSet set = instruction_set();
  const bool too_slow = set == InstructionSet::avx2 && has_slow_pext();
  return kernel_for(too_slow ? InstructionSet::portable : set, TALUS_KERNELS(triangle_kernel));
}

MaskRows rows_of(const RestrictedQuadtree& quadtree) {
  const VertexMask& mask = quadtree.vertices;
  const GridRect& window = mask.region();
  MaskRows rows;
  rows.words = mask.row_words(window.first.row).data();
  rows.before = mask.row_ranks(window.first.row).data();
  if (!quadtree.covers.empty()) rows.covers = quadtree.covers.data();
  rows.words_per_row = static_cast<std::int64_t>(mask.row_words(window.first.row).size());
  rows.first_col = window.first.col, rows.first_row = window.first.row;
  rows.last_col = window.last.col, rows.last_row = window.last.row;
  return rows;
}

/// The triangles of some rows, in their order.
class RowsOfTriangles {
 public:
  explicit RowsOfTriangles(const RestrictedQuadtree& quadtree)
      : quadtree_(quadtree), rows_(rows_of(quadtree)), kernel_(triangle_kernel()), around_(quadtree) {}

  [[nodiscard]] std::size_t count(const RowRange& part, const std::stop_token& stop) {
    std::size_t sum = 0;
    for_each_row(part, stop, [&](std::int32_t row) {
      sum += kernel_.count_leaves(rows_, row);
      for_each_large(row, [&](GridPoint p) {
        std::array<Corners, kMostAround> found;
        sum += static_cast<std::size_t>(large(p, found.data()) - found.data());
      });
    });
    return sum;
  }

  /// Writes them, and the points and heights of the rows; returns their end.
  ///
  /// fails  corrupt: a corner is missing, or the triangles do not fit
  Corners* write(const RowRange& part, const std::stop_token& stop, Mesh& mesh, Corners* out, const Corners* room_end) {
    bool closed = true;
    auto* const numbers = reinterpret_cast<std::uint32_t*>(mesh.points.data());
    const std::size_t points_begin = rank_of_row(part.first), points_end = rank_of_row(part.last + std::int64_t{1});
    for_each_row(part, stop, [&](std::int32_t row) {
      const std::size_t first = rank_of_row(row);
      const std::size_t most = kMostAround * (rank_of_row(row + std::int64_t{1}) - first);
      // The kernel writes beyond the last triangle. Near the end of the room it writes elsewhere.
      const bool fits = static_cast<std::size_t>(room_end - out) >= most + kWrittenAhead;
      if (!fits) spare_.resize(std::max(spare_.size(), most + kWrittenAhead));
      Corners* const start = fits ? out : spare_.data();
      std::uint32_t* const kernel_end = kernel_.leaves(rows_, row, start->data(), closed);
      Corners* end = start + (kernel_end - start->data()) / 3;
      for_each_large(row, [&](GridPoint p) { end = large(p, end); });
      if (!fits) {
        if (end - start > room_end - out) refuse_not_closed();
        std::copy(start, end, out);
      }
      out += end - start;
      kernel_.points(rows_, row, numbers + 2 * first, numbers + 2 * points_end);
    });
    if (!closed || !around_.closed()) refuse_not_closed();
    const auto heights = quadtree_.heights.begin();
    std::copy(heights + static_cast<std::ptrdiff_t>(points_begin), heights + static_cast<std::ptrdiff_t>(points_end),
              mesh.heights.begin() + static_cast<std::ptrdiff_t>(points_begin));
    return out;
  }

 private:
  template <class Visit>
  void for_each_row(const RowRange& part, const std::stop_token& stop, Visit&& visit) {
    for (std::int64_t row = part.first; row <= part.last; ++row) {
      if ((row - part.first) % kRowsAtOnce == 0) refuse_if_stopped(stop);
      if (rank_of_row(row) != rank_of_row(row + 1)) visit(static_cast<std::int32_t>(row));
    }
  }
  /// The vertices that the kernel leaves to us.
  template <class Visit>
  void for_each_large(std::int32_t row, Visit&& visit) {
    constexpr std::int32_t kStep = 2 * kMostWordSpacing;
    if (row % kStep != 0) return;
    const GridRect& window = quadtree_.vertices.region();
    for (std::int64_t col = (window.first.col + std::int64_t{kStep} - 1) & -kStep; col <= window.last.col;
         col += kStep) {
      const GridPoint p{static_cast<std::int32_t>(col), row};
      if (quadtree_.vertices.contains(p)) visit(p);
    }
  }
  Corners* large(GridPoint p, Corners* out) {
    const std::uint32_t self = quadtree_.vertices.rank(p);
    return around_.write(p, self, quadtree_.covers.empty() ? std::uint8_t{15} : quadtree_.covers[self], out);
  }
  [[nodiscard]] std::size_t rank_of_row(std::int64_t row) const {
    const std::int64_t at = row - rows_.first_row;
    return row > rows_.last_row ? quadtree_.vertices.size() : rows_.before[at * rows_.words_per_row];
  }

  const RestrictedQuadtree& quadtree_;
  MaskRows rows_;
  const TriangleKernel& kernel_;
  LeavesAround around_;
  std::vector<Corners> spare_;
};

}  // namespace

bool is_worth_words(const RestrictedQuadtree& quadtree) {
  // Where the two ways take about equally long with AVX2 (docs/decisions/0011-triangulation-by-words.md).
  constexpr std::size_t kFewestVertices = 8192, kMostSamplesAVertex = 64;
  const GridRect& window = quadtree.vertices.region();
  const std::size_t vertices = quadtree.vertices.size();
  return vertices >= kFewestVertices && vertices >= static_cast<std::size_t>(window.samples()) / kMostSamplesAVertex &&
         answered(quadtree) == window;
}

void triangulate_by_words(const RestrictedQuadtree& quadtree, Mesh& mesh, int threads, const std::stop_token& stop) {
  const std::size_t vertices = quadtree.vertices.size();
  const int most = threads_for(vertices, threads);
  begin_mesh(quadtree, mesh);
  // Each thread writes some pieces. Where it begins is known when all triangles before have been counted; the pieces
  // are so many that all threads can count.
  const std::vector<RowRange> pieces = parts_of(quadtree.vertices, most * most);
  const std::size_t parts = std::min(pieces.size(), static_cast<std::size_t>(most));
  const auto first_piece = [&](std::size_t part) { return part * pieces.size() / parts; };
  std::vector<std::size_t> counts(first_piece(parts - 1));
  for_each_task(most, counts.size(),
                [&](int, std::size_t i) { counts[i] = RowsOfTriangles(quadtree).count(pieces[i], stop); });
  std::vector<std::size_t> starts(parts + 1, 0);
  for (std::size_t part = 1; part < parts; ++part) {
    starts[part] = std::accumulate(counts.begin() + static_cast<std::ptrdiff_t>(first_piece(part - 1)),
                                   counts.begin() + static_cast<std::ptrdiff_t>(first_piece(part)), starts[part - 1]);
  }
  starts[parts] = 2 * vertices;  // a planar mesh has fewer than two triangles a vertex
  if (starts[parts - 1] > starts[parts]) refuse_not_closed();
  resize_unset(mesh.triangles, starts[parts]);
  std::size_t triangles = 0;
  for_each_task(most, parts, [&](int, std::size_t part) {
    const RowRange rows{pieces[first_piece(part)].first, pieces[first_piece(part + 1) - 1].last, 0};
    Corners* const first = mesh.triangles.data();
    const Corners* const end =
        RowsOfTriangles(quadtree).write(rows, stop, mesh, first + starts[part], first + starts[part + 1]);
    if (part + 1 == parts) triangles = static_cast<std::size_t>(end - first);
  });
  mesh.triangles.resize(triangles);
  finish_mesh(quadtree, mesh);
}

}  // namespace talus::detail
