#include "engine/quadtree/triangulation_by_vertices.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "engine/machine/cpu.hpp"
#include "engine/machine/parallel.hpp"
#include "engine/quadtree/leaves.hpp"

namespace talus::detail {
namespace {

class Emitter {
 public:
  /// Writes to `out`, which holds `room` triangles.
  Emitter(const RestrictedQuadtree& quadtree, Mesh& mesh, Corners* out, std::size_t room)
      : quadtree_(quadtree), points_(mesh.points.data()), out_(out), last_(out + room - kMostAround) {}

  /// Writes the leaves around each vertex of some rows; returns the end of the triangles. Each triangle is written,
  /// then kept or overwritten: a branch predictor cannot guess which of them are leaves.
  ///
  /// fails  corrupt: a corner is missing
  TALUS_INLINE Corners* run(std::int32_t first_row, std::int32_t last_row) {
    const bool all_covered = quadtree_.covers.empty();
    std::uint32_t self = mask_.rank({window_.first.col, first_row});
    mask_.for_each_in_rows(
        first_row, last_row, [&](GridPoint p) __attribute__((always_inline)) {
          points_[self] = p;
          const std::uint8_t covers = all_covered ? std::uint8_t{15} : quadtree_.covers[self];
          const std::int32_t s = spacing(p);
          const bool inner = p.col - s >= region_.first.col && p.col + s <= region_.last.col &&
                             p.row - s >= region_.first.row && p.row + s <= region_.last.row;
          if (!inner || covers != 15 || s == kRootSpacing) {
            any(p, self, covers);
          } else if (s == 1) {
            ((p.col & p.row) & 1) != 0 ? finest_centre(p, self) : finest_side(p, self);
          } else {
            is_centre(p) ? centre(p, self, s) : side(p, self, s);
          }
          ++self;
          if (out_ > last_) refuse_not_closed();  // the next triangles might not fit
        });
    if (!closed_ || !any_.closed()) refuse_not_closed();
    return out_;
  }

 private:
  /// Logical and without a branch.
  static constexpr bool all(int a, int b, int c = 1, int d = 1) { return (a & b & c & d) != 0; }

  TALUS_INLINE void keep(Corners corners, bool leaf) {
    *out_ = corners;
    out_ += leaf ? 1 : 0;
  }

  /// Its four neighbours are vertices, and there are no finer ones.
  TALUS_INLINE void finest_side(GridPoint p, std::uint32_t self) {
    const std::uint32_t north = mask_.rank({p.col, p.row - 1}), south = mask_.rank({p.col, p.row + 1});
    const std::uint32_t west = self - 1, east = self + 1;
    closed_ &= all(mask_.contains({p.col, p.row - 1}), mask_.contains({p.col, p.row + 1}),
                   mask_.contains({p.col - 1, p.row}), mask_.contains({p.col + 1, p.row}));
    keep({self, north, west}, true);
    keep({self, west, south}, true);
    keep({self, south, east}, true);
    keep({self, east, north}, true);
  }

  /// Its four corners are vertices; there may be side midpoints between them.
  TALUS_INLINE void finest_centre(GridPoint p, std::uint32_t self) {
    const bool north = mask_.contains({p.col, p.row - 1}), south = mask_.contains({p.col, p.row + 1});
    const bool west = mask_.contains({p.col - 1, p.row}), east = mask_.contains({p.col + 1, p.row});
    const std::uint32_t nw = mask_.rank({p.col - 1, p.row - 1}), ne = nw + 1 + (north ? 1 : 0);
    const std::uint32_t sw = mask_.rank({p.col - 1, p.row + 1}), se = sw + 1 + (south ? 1 : 0);
    closed_ &= all(mask_.contains({p.col - 1, p.row - 1}), mask_.contains({p.col + 1, p.row - 1}),
                   mask_.contains({p.col - 1, p.row + 1}), mask_.contains({p.col + 1, p.row + 1}));
    keep({self, ne, nw}, !north);
    keep({self, nw, sw}, !west);
    keep({self, sw, se}, !south);
    keep({self, se, ne}, !east);
  }

  /// Its four neighbours are vertices; there may be centres of half the spacing between them.
  TALUS_INLINE void side(GridPoint p, std::uint32_t self, std::int32_t s) {
    const std::int32_t h = s / 2;
    const GridPoint n{p.col, p.row - s}, w{p.col - s, p.row}, so{p.col, p.row + s}, e{p.col + s, p.row};
    const std::uint32_t north = mask_.rank(n), west = mask_.rank(w), south = mask_.rank(so), east = mask_.rank(e);
    closed_ &= all(mask_.contains(n), mask_.contains(w), mask_.contains(so), mask_.contains(e));
    keep({self, north, west}, !mask_.contains({p.col - h, p.row - h}));
    keep({self, west, south}, !mask_.contains({p.col - h, p.row + h}));
    keep({self, south, east}, !mask_.contains({p.col + h, p.row + h}));
    keep({self, east, north}, !mask_.contains({p.col + h, p.row - h}));
  }

  /// Its four corners are vertices; there may be side midpoints between them.
  TALUS_INLINE void centre(GridPoint p, std::uint32_t self, std::int32_t s) {
    const GridPoint nw{p.col - s, p.row - s}, ne{p.col + s, p.row - s}, sw{p.col - s, p.row + s},
        se{p.col + s, p.row + s};
    const std::uint32_t north_west = mask_.rank(nw), north_east = mask_.rank(ne);
    const std::uint32_t south_west = mask_.rank(sw), south_east = mask_.rank(se);
    closed_ &= all(mask_.contains(nw), mask_.contains(ne), mask_.contains(sw), mask_.contains(se));
    keep({self, north_east, north_west}, !mask_.contains({p.col, p.row - s}));
    keep({self, north_west, south_west}, !mask_.contains({p.col - s, p.row}));
    keep({self, south_west, south_east}, !mask_.contains({p.col, p.row + s}));
    keep({self, south_east, north_east}, !mask_.contains({p.col + s, p.row}));
  }

  void any(GridPoint p, std::uint32_t self, std::uint8_t covers) { out_ = any_.write(p, self, covers, out_); }

  const RestrictedQuadtree& quadtree_;
  const VertexMask& mask_ = quadtree_.vertices;
  GridRect region_ = answered(quadtree_), window_ = mask_.region();
  LeavesAround any_{quadtree_};
  GridPoint* points_;
  Corners* out_;
  const Corners* last_;  ///< the last position of out_ with enough room
  bool closed_ = true;   ///< all corners so far are vertices
};

TALUS_POPCNT Corners* emit_popcnt(Emitter& emitter, std::int32_t first, std::int32_t last) {
  return emitter.run(first, last);
}
Corners* emit_plain(Emitter& emitter, std::int32_t first, std::int32_t last) { return emitter.run(first, last); }

}  // namespace

void triangulate_by_vertices(const RestrictedQuadtree& quadtree, Mesh& mesh, int threads, const std::stop_token& stop) {
  constexpr std::int64_t kRowsAtOnce = 256;  // between two checks of the stop token
  const std::size_t count = quadtree.vertices.size();
  threads = threads_for(count, threads);
  begin_mesh(quadtree, mesh);
  if (count == 0) return;
  // A planar mesh has fewer than two triangles a vertex, a part of it at most four. The first part is written in place;
  // the others are copied when their positions are known.
  resize_unset(mesh.triangles, 2 * count + kMostAround);
  const std::vector<RowRange> parts = parts_of(quadtree.vertices, threads);
  std::vector<Array<Corners>> written(parts.size());
  std::vector<std::size_t> sizes(parts.size());
  for_each_task(threads, parts.size(), [&](int, std::size_t i) {
    const RowRange& part = parts[i];
    if (i > 0) written[i].resize(4 * part.vertices + kMostAround);
    Array<Corners>& to = i > 0 ? written[i] : mesh.triangles;
    Emitter emitter(quadtree, mesh, to.data(), to.size());
    const Corners* end = to.data();
    for (std::int64_t row = part.first; row <= part.last; row += kRowsAtOnce) {
      refuse_if_stopped(stop);
      const auto first_row = static_cast<std::int32_t>(row);
      const auto last_row = static_cast<std::int32_t>(std::min<std::int64_t>(part.last, row + kRowsAtOnce - 1));
      end = has_popcnt() ? emit_popcnt(emitter, first_row, last_row) : emit_plain(emitter, first_row, last_row);
    }
    sizes[i] = static_cast<std::size_t>(end - to.data());
    const std::size_t first = quadtree.vertices.rank({quadtree.vertices.region().first.col, part.first});
    std::copy_n(quadtree.heights.begin() + static_cast<std::ptrdiff_t>(first), part.vertices,
                mesh.heights.begin() + static_cast<std::ptrdiff_t>(first));
  });
  std::vector<std::size_t> starts(parts.size() + 1, 0);
  std::partial_sum(sizes.begin(), sizes.end(), starts.begin() + 1);
  mesh.triangles.resize(starts.back());
  for_each_task(threads, parts.size(), [&](int, std::size_t i) {
    if (i > 0)
      std::copy_n(written[i].begin(), sizes[i], mesh.triangles.begin() + static_cast<std::ptrdiff_t>(starts[i]));
  });
  finish_mesh(quadtree, mesh);
}

}  // namespace talus::detail
