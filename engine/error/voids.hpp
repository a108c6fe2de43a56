#pragma once
// Voids: which triangles hold data, and the height (fill) of each void vertex that a triangle can need.
//
// A finest triangle is half of a unit cell, cut along the diagonal that joins corners with even col+row. It is valid if
// its three corners are. A larger triangle holds data if it contains a valid finest one.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/error/height_field.hpp"
#include "engine/error/level_grid.hpp"
#include "engine/quadtree/half_diamond.hpp"

namespace talus {

/// What the finest triangles in a triangle are. A triangle that leaves the extent holds nothing and is never in a mesh.
enum Holds : std::uint8_t { kNothing = 0, kData = 1, kVoid = 2, kMixed = 3 };

class VoidMap {
 public:
  /// Over the finest levels. Linear time; 1⅓ bytes a sample.
  VoidMap(GridRect extent, std::span<const std::uint8_t> valid, int levels);
  /// The same as a new map, reusing the memory.
  void reset(GridRect extent, std::span<const std::uint8_t> valid, int levels);

  [[nodiscard]] Holds half(GridPoint vertex, int side) const {
    return static_cast<Holds>(halves_[vertex] >> (2 * side) & 3);
  }
  /// By level: side 0 | side 1 << 2 of each vertex.
  [[nodiscard]] LevelGrid<std::uint8_t>::Units units(int shift) { return halves_.units(shift); }
  [[nodiscard]] int levels() const { return halves_.levels(); }
  [[nodiscard]] bool holds(GridPoint vertex) const { return halves_.holds(vertex); }
  /// Four bits in the order of apex_triangles(): which triangles hold data. For vertices of the map's levels.
  [[nodiscard]] std::uint8_t apex_triangles_with_data(GridPoint vertex) const;

 private:
  [[nodiscard]] Holds finest(Triangle t) const;
  [[nodiscard]] Holds triangle(Triangle t) const;  ///< for one of apex_triangles(p)

  GridRect extent_;
  std::span<const std::uint8_t> valid_;
  LevelGrid<std::uint8_t> halves_;
};

/// How far a fill may come from, in columns and rows.
inline constexpr std::int32_t kFillReach = 64;

/// Sets the heights of void vertices. A vertex that is above the map's levels, or can be a corner of a triangle with
/// data, looks at squares of radius 1, 2, 4 … kFillReach around it. From the first with a valid sample it copies the
/// sample nearest to the middle of the range, the lower of two. So fills fit every height step and depend on nothing
/// farther away. All other void vertices become 0.
///
/// within  only voids of this rectangle; others keep their heights
void fill_voids(GridRect extent, std::span<const std::uint8_t> valid, const VoidMap& voids, GridRect within,
                Codes& heights);

/// Whether a valid sample lies within kFillReach of a void vertex.
[[nodiscard]] bool has_data_near(GridRect extent, std::span<const std::uint8_t> valid, GridPoint p);

}  // namespace talus
