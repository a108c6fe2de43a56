#pragma once
// Terrains of any shape and any kind of number, with voids or without.

#include <cmath>

#include "tests/support/surfaces.hpp"

namespace talus::support {

enum class Numbers { whole, wild_whole, wide_whole, halves, floats, decimals, doubles };
inline constexpr int kNumbers = 7;

inline Terrain random_terrain(Random& random, Numbers numbers, int cols, int rows) {
  const std::uint64_t seed = random.next();
  Terrain terrain;
  switch (random.between(0, 6)) {
    case 0: terrain = fractal(cols, rows, seed); break;
    case 1: terrain = noise(cols, rows, seed, -50, 50); break;
    case 2: terrain = plateaus(cols, rows); break;
    case 3: terrain = cliff(cols, rows, 777); break;
    case 4: terrain = spike(cols, rows, random.between(0, cols - 1), random.between(0, rows - 1)); break;
    case 5: terrain = checkerboard(cols, rows); break;
    default: terrain = plane(cols, rows, 10, 1.0 / 7, 3); break;
  }
  for (double& v : terrain.values) {
    switch (numbers) {
      case Numbers::whole: v = std::nearbyint(v); break;
      // Far beyond what 32 bits hold without rounding.
      case Numbers::wild_whole: v = std::nearbyint(v * 1e4 + (random.chance(0.01) ? 1e9 : 0)); break;
      // Beyond 16 bits, but within them up to a base.
      case Numbers::wide_whole: v = std::nearbyint(v) + 100000; break;
      case Numbers::halves: v = std::nearbyint(v * 8) / 8; break;
      case Numbers::floats: v = static_cast<double>(static_cast<float>(v / 3)); break;
      case Numbers::decimals: v = static_cast<double>(static_cast<float>(std::nearbyint(v * 10) / 10)); break;
      case Numbers::doubles: v = v / 10 + 0.1; break;
    }
  }
  switch (random.between(0, 6)) {
    case 0: return void_blobs(std::move(terrain), random.between(1, 4), seed);
    case 1: return random_voids(std::move(terrain), random.log_between(1e-4, 0.9), seed);
    case 2: return void_diagonals(std::move(terrain), random.between(2, 40));
    case 3: return random_voids(std::move(terrain), 1 - random.log_between(1e-5, 0.1), seed);
    default: return terrain;
  }
}

}  // namespace talus::support
