#pragma once
// Terrains as the error computation sees them, anywhere on the grid.

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/quadtree/rect.hpp"
#include "engine/tile/tile.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {

inline Terrain whole(Terrain terrain) {
  for (double& v : terrain.values) v = std::nearbyint(v) + 0.0;  // never -0
  return terrain;
}
/// As floats that are nearest to whole numbers over `per_unit`.
inline Terrain rounded(Terrain terrain, double per_unit) {
  for (double& v : terrain.values) v = static_cast<double>(static_cast<float>(std::nearbyint(v * per_unit) / per_unit));
  return terrain;
}

/// The narrowest codes that hold a terrain's numbers.
inline Codes codes_of(const std::vector<double>& values) {
  const auto all = [&](auto&& fits) { return std::all_of(values.begin(), values.end(), fits); };
  if (all([](double v) { return v >= -32768 && v <= 32767 && v == std::nearbyint(v); })) {
    return std::vector<std::int16_t>(values.begin(), values.end());
  }
  if (all([](double v) { return v == static_cast<double>(static_cast<float>(v)); })) {
    return std::vector<float>(values.begin(), values.end());
  }
  return values;
}

inline int levels_of(GridRect extent) { return std::countr_zero(static_cast<std::uint32_t>(root_side(extent))); }

/// The fill of a void vertex as its rule says, by plain loops.
inline std::optional<double> plain_fill(const HeightField& field, GridPoint p) {
  for (std::int32_t reach = 1; reach <= kFillReach; reach *= 2) {
    std::vector<double> found;
    for (std::int32_t row = p.row - reach; row <= p.row + reach; ++row) {
      for (std::int32_t col = p.col - reach; col <= p.col + reach; ++col) {
        if (field.extent.contains({col, row}) && field.is_valid(field.index({col, row})))
          found.push_back(field[{col, row}]);
      }
    }
    if (found.empty()) continue;
    std::sort(found.begin(), found.end());
    const double middle = found.front() + (found.back() - found.front()) / 2;
    return *std::min_element(found.begin(), found.end(), [&](double a, double b) {  // the lower of two comes first
      return std::abs(a - middle) < std::abs(b - middle);
    });
  }
  return std::nullopt;
}

/// Everything an ErrorInput looks at, kept alive together.
struct Field {
  GridRect extent;
  Codes codes;
  std::vector<std::uint8_t> valid;
  std::optional<VoidMap> voids;  ///< of all levels
  std::optional<BlockBits> bits;
  ErrorInput input;

  /// `first` is where the terrain's north-west sample stands; cells are a metre. Fills are those that tiles give:
  /// needed by a triangle of the tiles' levels, or of a vertex above them.
  explicit Field(const Terrain& terrain, GridPoint first = {0, 0}, HeightStep step = {})
      : extent{first, {first.col + terrain.cols - 1, first.row + terrain.rows - 1}},
        codes(codes_of(terrain.values)),
        valid(terrain.valid) {
    input.field = {extent, view(codes),
                   terrain.has_voids() ? std::span<const std::uint8_t>(valid) : std::span<const std::uint8_t>(),
                   CodeDistance(step, 1)};
    if (terrain.has_voids()) {
      voids.emplace(extent, valid, std::max(levels_of(extent), kTileLevels));
      fill();
    }
    if (!std::holds_alternative<std::vector<std::int16_t>>(codes)) {
      bits.emplace(input.field);
      input.bits = &*bits;
    }
    input.voids = voids ? &*voids : nullptr;
    input.ground_side = [](const HalfDiamond& t) { return static_cast<double>((t.centre ? 3 : 2) * t.s); };
    input.void_weight = 1;
  }
  Field(const Field&) = delete;
  Field& operator=(const Field&) = delete;

  [[nodiscard]] std::size_t index(GridPoint p) const { return input.field.index(p); }
  [[nodiscard]] int levels() const { return levels_of(extent); }

 private:
  /// Its triangles leave the extent: smaller ones may have it at an end of their hypotenuse.
  [[nodiscard]] bool leaves(GridPoint p) const {
    const std::int32_t s = spacing(p);
    return s > 1 && !(extent.contains({p.col - s, p.row - s}) && extent.contains({p.col + s, p.row + s}));
  }
  void fill() {
    for (std::int32_t row = extent.first.row; row <= extent.last.row; ++row) {
      for (std::int32_t col = extent.first.col; col <= extent.last.col; ++col) {
        const GridPoint p{col, row};
        if (valid[index(p)]) continue;
        const bool needed = spacing(p) >= kBlockSide || voids->apex_triangles_with_data(p) != 0 || leaves(p);
        const double height = needed ? plain_fill(input.field, p).value_or(0) : 0;
        std::visit([&](auto& c) { c[index(p)] = static_cast<std::decay_t<decltype(c[0])>>(height); }, codes);
      }
    }
  }
};

/// visit(GridPoint) for every vertex a level grid holds.
template <class Value, class Visit>
void for_each_vertex(const LevelGrid<Value>& grid, Visit&& visit) {
  for (int shift = 0; shift < grid.levels(); ++shift) {
    grid.for_each(shift, false, visit);
    grid.for_each(shift, true, visit);
  }
}

inline std::string name_of(GridPoint p) { return "(" + std::to_string(p.col) + ", " + std::to_string(p.row) + ")"; }

}  // namespace talus::support
