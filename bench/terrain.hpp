#pragma once
// Ground for benches: a made terrain that everyone has, and the real models beside it where they are.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace talus::bench {

/// Whole metres, mountains of some 2,000 m with detail down to single cells: ridges of halving wavelength
/// over hashed lattice values.
inline std::vector<double> mountains(int side) {
  const auto hash = [](std::uint32_t x, std::uint32_t y, std::uint32_t octave) {
    std::uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ octave * 0xC2B2AE3Du;
    h = (h ^ h >> 15) * 0x2C1B3C6Du;
    h = (h ^ h >> 12) * 0x297A2D39u;
    return static_cast<double>(h ^ h >> 15) / 4294967296.0;
  };
  std::vector<double> heights(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      double height = 0, amplitude = 1000, size = 512;
      for (std::uint32_t octave = 0; octave < 10; ++octave, amplitude *= 0.47, size /= 2) {
        const double x = col / size, y = row / size, fx = x - std::floor(x), fy = y - std::floor(y);
        const auto ix = static_cast<std::uint32_t>(x), iy = static_cast<std::uint32_t>(y);
        const double u = fx * fx * (3 - 2 * fx), v = fy * fy * (3 - 2 * fy);
        const double top = hash(ix, iy, octave) * (1 - u) + hash(ix + 1, iy, octave) * u;
        const double bottom = hash(ix, iy + 1, octave) * (1 - u) + hash(ix + 1, iy + 1, octave) * u;
        height += amplitude * (top * (1 - v) + bottom * v);
      }
      heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(side) + static_cast<std::size_t>(col)] =
          std::round(height);
    }
  }
  return heights;
}

/// A file of the real models, if they are on this machine.
inline std::optional<std::filesystem::path> real_model(const std::string& name) {
  const char* folder = std::getenv("TALUS_DEM_DIR");
  const auto file = std::filesystem::path(folder != nullptr ? folder : "../shared/dem") / name;
  if (!std::filesystem::exists(file)) return std::nullopt;
  return file;
}

}  // namespace talus::bench
