#pragma once
// Answers at random: any rectangle, voids, and borders that triangles may cross.

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "engine/quadtree/border.hpp"
#include "talus/quadtree.hpp"
#include "tests/engine/closed_sets.hpp"

namespace talus::support {

/// Counter-clockwise corners, from the least on: triangles with one orientation are equal if these are.
using Turned = std::array<Point, 3>;
inline Turned turned(GridPoint x, GridPoint y, GridPoint z) {
  Turned corners{key(x), key(y), key(z)};
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}
inline std::multiset<Turned> turned_triangles(const Mesh& mesh) {
  std::multiset<Turned> found;
  for (const auto& t : mesh.triangles) found.insert(turned(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
  return found;
}

inline double random_height(GridPoint p) { return (p.row * 37 + p.col * 11) % 1000; }

inline GridRect random_rect(Random& random, std::int32_t side = 100) {
  const GridPoint first = random.chance(0.3)
                              ? GridPoint{0, 0}
                              : GridPoint{random.between(-side - 20, side / 2), random.between(-side - 20, side / 2)};
  return {first, {first.col + random.between(1, side), first.row + random.between(1, side)}};
}

/// Vertices of all levels over a rectangle whose border is constrained. Now and then with triangles that hold no data,
/// or with a region inside the rectangle, whose border triangles cross.
inline RestrictedQuadtree random_answer(Random& random, GridRect window, int points) {
  ClosedSet set(2 * root_side(window));
  for (const GridPoint p : border_vertices(window, set.root())) set.insert(p);
  const double fine = random.unit();
  for (int i = 0; i < points; ++i) {
    GridPoint p = random_point(random, window);
    if (!random.chance(fine)) {
      const std::int32_t mask = -(1 << random.between(0, 5));
      p = {p.col & mask, p.row & mask};
    }
    if (window.contains(p)) set.insert(p);
  }
  RestrictedQuadtree answer;
  answer.vertices = VertexMask(window);
  for (const Point& p : set.members()) {
    if (window.contains(point(p))) answer.vertices.insert(point(p));
  }
  for_each_point(window, [&](GridPoint p) {
    if (spacing(p) >= set.root()) answer.vertices.insert(p);
  });
  answer.vertices.seal();
  answer.vertices.for_each([&](GridPoint p) { answer.heights.push_back(random_height(p)); });
  if (random.chance(0.4)) {
    const double kept = random.unit();
    for (std::size_t v = 0; v < answer.vertices.size(); ++v) {
      unsigned bits = 0;
      for (unsigned i = 0; i < 4; ++i) bits |= random.chance(kept) ? 1u << i : 0u;
      answer.covers.push_back(static_cast<std::uint8_t>(bits));
    }
  }
  if (random.chance(0.3)) {
    const GridPoint x = random_point(random, window), y = random_point(random, window);
    answer.region = {{std::min(x.col, y.col), std::min(x.row, y.row)},
                     {std::max(x.col, y.col), std::max(x.row, y.row)}};
  }
  return answer;
}

}  // namespace talus::support
