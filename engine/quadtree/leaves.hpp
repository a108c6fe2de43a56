#pragma once
// What the two ways of triangulating share: triangulation_by_vertices and triangulation_by_words.

#include <array>
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "engine/quadtree/grid.hpp"
#include "talus/quadtree.hpp"

namespace talus::detail {

/// Vertex numbers of a triangle.
using Corners = std::array<std::uint32_t, 3>;
inline constexpr std::size_t kMostAround = 4;  ///< apex triangles of a vertex

/// The region of an answer.
[[nodiscard]] GridRect answered(const RestrictedQuadtree& quadtree);

/// fails  corrupt: a vertex lacks its parents
[[noreturn]] void refuse_not_closed();
/// fails  cancelled
void refuse_if_stopped(const std::stop_token& stop);

/// The leaves around any vertex: at a border, with or without data, of any spacing. Slow, and the definition that
/// faster code is held to.
class LeavesAround {
 public:
  explicit LeavesAround(const RestrictedQuadtree& quadtree);
  /// Writes the leaves around p, whose rank is `self`, to out[0 … 3] at most. Returns their end.
  Corners* write(GridPoint p, std::uint32_t self, std::uint8_t covers, Corners* out);
  /// Whether all corners so far were vertices.
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  const VertexMask& mask_;
  GridRect region_, window_;
  bool reaches_out_, closed_ = true;
};

/// Some rows, both included, and the number of their vertices.
struct RowRange {
  std::int32_t first = 0, last = 0;
  std::size_t vertices = 0;
};
/// Parts of the rows with about equally many vertices: `count`, or fewer.
[[nodiscard]] std::vector<RowRange> parts_of(const VertexMask& mask, int count);

/// Gives an array a size. Its content is lost, and elements are unset.
template <class T>
void resize_unset(Array<T>& array, std::size_t size) {
  if (array.capacity() < size) array.clear();  // so that growing copies nothing
  array.resize(size);
}

/// Gives a mesh its region and the size of its points and heights. Its other content is lost.
void begin_mesh(const RestrictedQuadtree& quadtree, Mesh& mesh);
/// Removes the points that no triangle uses.
void finish_mesh(const RestrictedQuadtree& quadtree, Mesh& mesh);

/// The number of threads that are worth starting.
[[nodiscard]] int threads_for(std::size_t vertices, int threads);

}  // namespace talus::detail
