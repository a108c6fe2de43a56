#pragma once
// What counts as data: triangles that hold data, and one height for each void vertex a triangle can need.
//
// The finest triangles are the halves of unit cells along the diagonal that joins corners of even col+row; one
// is valid iff its three corners are, and a larger one holds data iff it holds a valid one.

#include <cstdint>
#include <span>
#include <vector>

#include "engine/half_diamond.hpp"
#include "engine/level_grid.hpp"

namespace talus {

/// What the finest triangles inside a triangle are. Beyond the extent there are none of either kind.
enum Holds : std::uint8_t { kNothing = 0, kData = 1, kVoid = 2, kMixed = 3 };

class VoidMap {
 public:
  /// Linear time, 1⅓ bytes a sample.
  VoidMap(GridRect extent, std::span<const std::uint8_t> valid);

  [[nodiscard]] Holds half(GridPoint vertex, int side) const {
    return static_cast<Holds>(halves_[vertex] >> (2 * side) & 3);
  }
  /// Four bits in the order of apex_triangles: which of them hold data.
  [[nodiscard]] std::uint8_t apex_triangles_with_data(GridPoint vertex) const;

 private:
  [[nodiscard]] Holds finest(Triangle t) const;
  [[nodiscard]] Holds triangle(Triangle t) const;  ///< one of apex_triangles(p), from the level below

  GridRect extent_;
  std::span<const std::uint8_t> valid_;
  LevelGrid<std::uint8_t> halves_;
};

/// Gives every void vertex that can be a corner of a triangle with data its height: that of the valid sample
/// of its own diamond that is nearest to the middle of their range. A value of the source's own is on
/// any height step, and the choice depends on nothing outside the diamond. Other voids become 0.
void fill_voids(GridRect extent, std::span<const std::uint8_t> valid, const VoidMap& voids, std::span<double> heights);

}  // namespace talus
