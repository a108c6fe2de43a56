#pragma once
// Small terrains whose meshes are known by thought. All sizes in samples, heights in any unit.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "tests/support/random.hpp"

namespace talus::support {

/// A raster in memory, row by row from the north; valid is 1 where the sample is data.
struct Terrain {
  int cols = 0, rows = 0;
  std::vector<double> values;
  std::vector<std::uint8_t> valid;

  Terrain() = default;
  Terrain(int c, int r)
      : cols(c), rows(r), values(static_cast<std::size_t>(c) * static_cast<std::size_t>(r)), valid(values.size(), 1) {}

  [[nodiscard]] std::size_t index(int col, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
  [[nodiscard]] double& at(int col, int row) { return values[index(col, row)]; }
  [[nodiscard]] double at(int col, int row) const { return values[index(col, row)]; }
  [[nodiscard]] bool is_valid(int col, int row) const { return valid[index(col, row)] != 0; }
  void make_void(int col, int row) { valid[index(col, row)] = 0; }
  [[nodiscard]] bool has_voids() const { return std::find(valid.begin(), valid.end(), 0) != valid.end(); }
  [[nodiscard]] bool has_data() const { return std::find(valid.begin(), valid.end(), 1) != valid.end(); }
};

/// Calls height(col, row) for every sample.
template <class Height>
Terrain surface(int cols, int rows, Height&& height) {
  Terrain terrain(cols, rows);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) terrain.at(col, row) = static_cast<double>(height(col, row));
  }
  return terrain;
}

/// A plane needs no vertex but those the border forces, at every tolerance.
inline Terrain plane(int cols, int rows, double base = 100, double east = 1, double south = 2) {
  return surface(cols, rows, [=](int col, int row) { return base + east * col + south * row; });
}

/// One sample stands out: below the spike's height its vertex and its ancestors are needed, above it nothing.
inline Terrain spike(int cols, int rows, int at_col, int at_row, double height = 50) {
  Terrain terrain = plane(cols, rows, 100, 0, 0);
  terrain.at(at_col, at_row) += height;
  return terrain;
}

inline Terrain pit(int cols, int rows, int at_col, int at_row, double depth = 50) {
  return spike(cols, rows, at_col, at_row, -depth);
}

/// A crest along the diagonal of the root, where two triangles of every level meet: they need only it.
inline Terrain diagonal_ridge(int cols, int rows, double slope = 3) {
  return surface(cols, rows, [=](int col, int row) { return 1000 - slope * std::abs(col - row); });
}

/// A crest along the other diagonal, which coarse triangles cross.
inline Terrain cross_ridge(int cols, int rows, double slope = 3) {
  return surface(cols, rows, [=](int col, int row) { return 1000 - slope * std::abs(cols - 1 - col - row); });
}

inline Terrain sine_hills(int cols, int rows, double amplitude = 100, double period = 37) {
  return surface(cols, rows, [=](int col, int row) {
    return 500 +
           amplitude * std::sin(6.283185307179586 * col / period) * std::cos(6.283185307179586 * row / (period * 1.3));
  });
}

/// Two levels with a step that no triangle edge follows for long.
inline Terrain cliff(int cols, int rows, double drop = 300) {
  return surface(cols, rows, [=](int col, int row) { return 3 * col + row < 2 * cols ? drop : 0.0; });
}

/// Terraces: much of it is exactly flat, and errors come in ties.
inline Terrain plateaus(int cols, int rows, double step = 10) {
  Terrain terrain = sine_hills(cols, rows, 60, 29);
  for (double& value : terrain.values) value = std::floor(value / step) * step;
  return terrain;
}

/// The roughest terrain a sample type can hold: differences of the whole range between neighbours.
inline Terrain checkerboard(int cols, int rows, double low = -32767, double high = 32767) {
  return surface(cols, rows, [=](int col, int row) { return (col + row) % 2 == 0 ? low : high; });
}

inline Terrain noise(int cols, int rows, std::uint64_t seed, double low = 0, double high = 1000) {
  Random random(seed);
  return surface(cols, rows, [&](int, int) { return random.within(low, high); });
}

/// Terrain by midpoint displacement: looks like mountains, and is cheap at any size.
inline Terrain fractal(int cols, int rows, std::uint64_t seed, double amplitude = 800, double roughness = 0.55) {
  int side = 1;
  while (side < std::max(cols, rows) - 1) side *= 2;
  const int width = side + 1;
  std::vector<float> grid(static_cast<std::size_t>(width) * static_cast<std::size_t>(width));
  const auto at = [&](int col, int row) -> float& {
    return grid[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(col)];
  };
  Random random(seed);
  const auto shift = [&](double by) { return static_cast<float>((random.unit() - 0.5) * by); };
  for (const int row : {0, side}) {
    for (const int col : {0, side}) at(col, row) = 1000 + shift(amplitude);
  }
  double reach = amplitude;
  for (int half = side / 2; half > 0; half /= 2, reach *= roughness) {
    for (int row = half; row < side; row += 2 * half) {
      for (int col = half; col < side; col += 2 * half) {
        at(col, row) = (at(col - half, row - half) + at(col + half, row - half) + at(col - half, row + half) +
                        at(col + half, row + half)) /
                           4 +
                       shift(reach);
      }
    }
    for (int row = 0; row <= side; row += half) {
      const bool even_row = row / half % 2 == 0;
      for (int col = even_row ? half : 0; col <= side; col += 2 * half) {
        const float along =
            even_row ? at(col - half, row) + at(col + half, row) : at(col, row - half) + at(col, row + half);
        at(col, row) = along / 2 + shift(reach * 0.7);
      }
    }
  }
  return surface(cols, rows, [&](int col, int row) { return at(col, row); });
}

// ---- voids -----------------------------------------------------------------------------------------

/// A rectangular hole, corners included, clipped to the terrain.
inline Terrain hole(Terrain terrain, int first_col, int first_row, int last_col, int last_row) {
  for (int row = std::max(0, first_row); row <= std::min(terrain.rows - 1, last_row); ++row) {
    for (int col = std::max(0, first_col); col <= std::min(terrain.cols - 1, last_col); ++col) {
      terrain.make_void(col, row);
    }
  }
  return terrain;
}

/// Single samples, here and there.
inline Terrain random_voids(Terrain terrain, double fraction, std::uint64_t seed) {
  Random random(seed);
  for (std::uint8_t& valid : terrain.valid) {
    if (random.chance(fraction)) valid = 0;
  }
  return terrain;
}

/// Lakes of void: round, some across the border of the data.
inline Terrain void_blobs(Terrain terrain, int count, std::uint64_t seed) {
  Random random(seed);
  for (int blob = 0; blob < count; ++blob) {
    const double col = random.within(0.0, terrain.cols), row = random.within(0.0, terrain.rows);
    const double radius = random.within(1.0, 0.3 * std::max(3, std::min(terrain.cols, terrain.rows)));
    for (int r = 0; r < terrain.rows; ++r) {
      for (int c = 0; c < terrain.cols; ++c) {
        if (std::hypot(c - col, r - row) < radius) terrain.make_void(c, r);
      }
    }
  }
  return terrain;
}

/// Lines of void one sample wide, falling and rising: they cut cells through corners only.
inline Terrain void_diagonals(Terrain terrain, int spacing, int offset = 0) {
  for (int row = 0; row < terrain.rows; ++row) {
    for (int col = 0; col < terrain.cols; ++col) {
      if ((col + row + offset) % spacing == 0 || (col - row + offset) % (2 * spacing) == 0) {
        terrain.make_void(col, row);
      }
    }
  }
  return terrain;
}

}  // namespace talus::support
