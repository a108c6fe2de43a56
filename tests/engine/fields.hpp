#pragma once
// Terrains as the error computation sees them, anywhere on the grid.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/vertex_error.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {

/// Everything an ErrorInput looks at, kept alive together.
struct Field {
  GridRect extent;
  std::vector<double> heights;
  std::vector<std::uint8_t> valid;
  std::optional<VoidMap> voids;
  ErrorInput input;

  /// `first` is where the terrain's north-west sample stands; cells are a metre.
  explicit Field(const Terrain& terrain, GridPoint first = {0, 0}, HeightStep step = {})
      : extent{first, {first.col + terrain.cols - 1, first.row + terrain.rows - 1}},
        heights(terrain.values),
        valid(terrain.valid) {
    if (terrain.has_voids()) {
      voids.emplace(extent, valid);
      fill_voids(extent, valid, *voids, heights);
    }
    input.field = {extent,
                   heights,
                   terrain.has_voids() ? std::span<const std::uint8_t>(valid) : std::span<const std::uint8_t>(),
                   CodeDistance(step, 1),
                   interpolation_is_exact(heights, root_side(extent)),
                   are_whole_numbers(heights)};
    input.voids = voids ? &*voids : nullptr;
    input.ground_side = [](const HalfDiamond& t) { return static_cast<double>((t.centre ? 3 : 2) * t.s); };
    input.void_weight = 1;
  }
  Field(const Field&) = delete;
  Field& operator=(const Field&) = delete;

  [[nodiscard]] std::size_t index(GridPoint p) const { return input.field.index(p); }
};

/// visit(GridPoint) for every vertex a level grid holds.
template <class Value, class Visit>
void for_each_vertex(const LevelGrid<Value>& grid, Visit&& visit) {
  for (int shift = 0; shift < grid.levels(); ++shift) {
    grid.for_each(shift, false, visit);
    grid.for_each(shift, true, visit);
  }
}

template <class Visit>
void for_each_point(GridRect rect, Visit&& visit) {
  for (std::int32_t row = rect.first.row; row <= rect.last.row; ++row) {
    for (std::int32_t col = rect.first.col; col <= rect.last.col; ++col) visit(GridPoint{col, row});
  }
}

inline std::string name_of(GridPoint p) { return "(" + std::to_string(p.col) + ", " + std::to_string(p.row) + ")"; }

}  // namespace talus::support
