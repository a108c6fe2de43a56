#include "engine/quadtree/unused_points.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "engine/machine/cpu.hpp"
#include "engine/quadtree/grid.hpp"
#include "engine/quadtree/leaves.hpp"

namespace talus::detail {
namespace {

/// Finds whether any triangle at a point is in the mesh, without looking at the mesh. Right for quadtrees as databases
/// have them; others may have been made by anybody.
class TrianglesAround {
 public:
  explicit TrianglesAround(const RestrictedQuadtree& quadtree)
      : mask_(quadtree.vertices), region_(mask_.region()), covers_(quadtree.covers) {}

  /// The apex triangles of a vertex are all that is around it. p is no root corner.
  [[nodiscard]] bool any(GridPoint p) const {
    const auto around = apex_triangles(p);
    return std::any_of(around.begin(), around.end(), [&](const Triangle& t) { return any_in(t, p); });
  }

 private:
  [[nodiscard]] bool is_inside(const Triangle& t) const {
    return region_.contains(t.apex) && region_.contains(t.left) && region_.contains(t.right);
  }
  /// Whether a triangle of the mesh lies in this one and has its corner p. None crosses a side of the region.
  [[nodiscard]] bool any_in(Triangle t, GridPoint p) const {
    while (!is_finest(t) && (!is_inside(t) || mask_.contains(midpoint(t.left, t.right)))) {
      if (p == t.apex) return any_in(left_half(t), p) || any_in(right_half(t), p);
      t = p == t.left ? left_half(t) : right_half(t);
    }
    return is_in_mesh(t);
  }
  /// Whether a triangle that is not split holds data.
  [[nodiscard]] bool is_in_mesh(const Triangle& t) const {
    if (!is_inside(t) || !mask_.contains(t.apex)) return false;
    const auto around = apex_triangles(t.apex);
    const auto found = std::find_if(around.begin(), around.end(), [&](const Triangle& a) {
      return (a.left == t.left && a.right == t.right) || (a.left == t.right && a.right == t.left);
    });
    return found != around.end() && (covers_[mask_.rank(t.apex)] >> (found - around.begin()) & 1) != 0;
  }

  const VertexMask& mask_;
  GridRect region_;
  std::span<const std::uint8_t> covers_;
};

std::vector<std::uint32_t> unused_by_triangles(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.points.size(), 0);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) used[v] = 1;
  }
  std::vector<std::uint32_t> unused;
  for (auto at = std::find(used.begin(), used.end(), 0); at != used.end(); at = std::find(at + 1, used.end(), 0))
    unused.push_back(static_cast<std::uint32_t>(at - used.begin()));
  return unused;
}

/// The vertices around which not all triangles hold data; nothing if they are more than `most`.
std::optional<std::vector<std::uint32_t>> partly_held(std::span<const std::uint8_t> covers, std::size_t most) {
  constexpr std::uint64_t kAll = 0x0f0f0f0f0f0f0f0f;  // 15 in each byte
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < covers.size() && found.size() <= most; i += 8) {
    std::uint64_t word = kAll;
    const std::size_t bytes = std::min<std::size_t>(8, covers.size() - i);
    std::memcpy(&word, &covers[i], bytes);
    if (word == kAll) continue;
    for (std::size_t k = i; k < i + bytes; ++k) {
      if (covers[k] != 15) found.push_back(static_cast<std::uint32_t>(k));
    }
  }
  if (found.size() > most) return std::nullopt;
  return found;
}

/// An unused point is a corner of a triangle without data: it is the vertex in its right angle, or a parent or an end
/// of that.
std::vector<std::uint32_t> unused_beside(std::span<const std::uint32_t> partly_held, const RestrictedQuadtree& quadtree,
                                         const Mesh& mesh) {
  const VertexMask& mask = quadtree.vertices;
  const TrianglesAround around(quadtree);
  std::vector<std::uint32_t> unused;
  const auto look_at = [&](GridPoint p) {
    if (!mask.region().contains(p) || !mask.contains(p)) return;
    const std::uint32_t rank = mask.rank(p);
    const auto has_it = [&](const Corners& t) { return t[0] == rank || t[1] == rank || t[2] == rank; };
    const bool is_used =
        spacing(p) == kRootSpacing ? std::any_of(mesh.triangles.begin(), mesh.triangles.end(), has_it) : around.any(p);
    if (!is_used) unused.push_back(rank);
  };
  for (const std::uint32_t i : partly_held) {
    const GridPoint p = mesh.points[i];
    look_at(p);
    if (spacing(p) == kRootSpacing) continue;
    const Diamond d = diamond(p);
    for (const GridPoint q : {d.apexes[0], d.apexes[1], d.ends[0], d.ends[1]}) look_at(q);
  }
  std::sort(unused.begin(), unused.end());
  unused.erase(std::unique(unused.begin(), unused.end()), unused.end());
  return unused;
}

constexpr std::size_t kFew = 8, kAtOnce = 4096;  ///< removed points; numbers

/// Calls visit(numbers, count) for the corners of all triangles, some at once.
template <class Visit>
void for_each_corners(Mesh& mesh, Visit&& visit) {
  auto* const corners = reinterpret_cast<std::uint32_t*>(mesh.triangles.data());
  const std::size_t count = 3 * mesh.triangles.size();
  for (std::size_t i = 0; i < count; i += kAtOnce) visit(corners + i, std::min(kAtOnce, count - i));
}

TALUS_CLONES bool has(const std::uint32_t* numbers, std::size_t count, std::uint32_t wanted) {
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < count; ++i) found |= numbers[i] == wanted ? 1 : 0;
  return found != 0;
}

/// Makes each number smaller by the removed ones below it, which are few.
TALUS_CLONES void renumber(std::uint32_t* numbers, std::size_t count, const std::uint32_t* removed,
                           std::size_t removed_count) {
  for (std::size_t k = removed_count; k-- > 0;) {  // the largest first, so that the smaller ones stay as they are
    const std::uint32_t gone = removed[k];
    for (std::size_t i = 0; i < count; ++i) numbers[i] -= numbers[i] > gone ? 1 : 0;
  }
}

/// The unused points if there are few voids and few such points; otherwise nothing.
std::optional<std::vector<std::uint32_t>> few_unused(const RestrictedQuadtree& quadtree, Mesh& mesh) {
  constexpr std::size_t kMostOfVertices = 32;  // a look at what is around a vertex takes as long as at 30 triangles
  if (quadtree.covers.empty() || mesh.triangles.empty() || !(answered(quadtree) == quadtree.vertices.region()))
    return std::nullopt;
  const auto partly = partly_held(quadtree.covers, mesh.points.size() / kMostOfVertices);
  if (!partly) return std::nullopt;
  std::vector<std::uint32_t> unused = unused_beside(*partly, quadtree, mesh);
  bool is_sure = unused.size() <= kFew;
  for_each_corners(mesh, [&](const std::uint32_t* corners, std::size_t count) {
    for (const std::uint32_t point : unused) is_sure = is_sure && !has(corners, count, point);
  });
  if (!is_sure) return std::nullopt;
  return unused;
}

void remove_points(Mesh& mesh, std::span<const std::uint32_t> removed) {
  if (removed.size() <= kFew) {
    for_each_corners(mesh,
                     [&](auto* corners, auto count) { renumber(corners, count, removed.data(), removed.size()); });
  }
  Array<std::uint32_t> number;
  if (removed.size() > kFew) number.resize(mesh.points.size());
  auto gone = removed.begin();
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (gone != removed.end() && *gone == i) {
      ++gone;
      continue;
    }
    if (!number.empty()) number[i] = next;
    mesh.points[next] = mesh.points[i];
    mesh.heights[next++] = mesh.heights[i];
  }
  mesh.points.resize(next);
  mesh.heights.resize(next);
  if (number.empty()) return;
  for_each_corners(mesh, [&](auto* corners, auto count) {
    std::transform(corners, corners + count, corners, [&](std::uint32_t v) { return number[v]; });
  });
}

}  // namespace

void remove_unused_points(const RestrictedQuadtree& quadtree, Mesh& mesh) {
  const auto few = few_unused(quadtree, mesh);
  const std::vector<std::uint32_t> unused = few ? *few : unused_by_triangles(mesh);
  if (!unused.empty()) remove_points(mesh, unused);
}

}  // namespace talus::detail
