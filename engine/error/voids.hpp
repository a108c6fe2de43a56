#pragma once
// What counts as data: triangles that hold data, and one height for each void vertex a triangle can need.
//
// The finest triangles are the halves of unit cells along the diagonal that joins corners of even col+row; one
// is valid iff its three corners are, and a larger one holds data iff it holds a valid one.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/error/height_field.hpp"
#include "engine/error/level_grid.hpp"
#include "engine/quadtree/half_diamond.hpp"

namespace talus {

/// What the finest triangles inside a triangle are. One that leaves the extent holds nothing: it is never in a mesh.
enum Holds : std::uint8_t { kNothing = 0, kData = 1, kVoid = 2, kMixed = 3 };

class VoidMap {
 public:
  /// Of the finest levels. Linear time, 1⅓ bytes a sample.
  VoidMap(GridRect extent, std::span<const std::uint8_t> valid, int levels);
  /// As if made anew, in the memory it has.
  void reset(GridRect extent, std::span<const std::uint8_t> valid, int levels);

  [[nodiscard]] Holds half(GridPoint vertex, int side) const {
    return static_cast<Holds>(halves_[vertex] >> (2 * side) & 3);
  }
  /// By level: side 0 | side 1 << 2 of every vertex.
  [[nodiscard]] LevelGrid<std::uint8_t>::Units units(int shift) { return halves_.units(shift); }
  [[nodiscard]] int levels() const { return halves_.levels(); }
  [[nodiscard]] bool holds(GridPoint vertex) const { return halves_.holds(vertex); }
  /// Four bits in the order of apex_triangles: which of them hold data. The vertex is of one of the levels.
  [[nodiscard]] std::uint8_t apex_triangles_with_data(GridPoint vertex) const;

 private:
  [[nodiscard]] Holds finest(Triangle t) const;
  [[nodiscard]] Holds triangle(Triangle t) const;  ///< one of apex_triangles(p), from the level below

  GridRect extent_;
  std::span<const std::uint8_t> valid_;
  LevelGrid<std::uint8_t> halves_;
};

/// How far from a void vertex its fill may come, in columns and rows.
inline constexpr std::int32_t kFillReach = 64;

/// Gives void vertices their heights. One that can be a corner of a triangle with data of the map's levels, or
/// is above them, gets the height of the valid sample nearest to the middle of the range (the lower of two) of
/// those in the square of radius r around it, r being the smallest of 1, 2, 4 … kFillReach that finds one. A
/// value of the source's own is on any height step, and the choice depends on nothing farther away. All
/// others become 0.
///
/// within  only voids of this rectangle; the others keep what they have
void fill_voids(GridRect extent, std::span<const std::uint8_t> valid, const VoidMap& voids, GridRect within,
                Codes& heights);

/// Whether a void vertex has a valid sample within kFillReach.
[[nodiscard]] bool has_data_near(GridRect extent, std::span<const std::uint8_t> valid, GridPoint p);

}  // namespace talus
