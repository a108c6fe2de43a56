#pragma once
// What both sides of coded strips know: the header, and how numbers lie in bits. docs/format/strip.md.

#include <array>
#include <bit>
#include <cstdint>

#include "talus/units.hpp"

namespace talus::strip_layout {

inline constexpr std::array<char, 8> kMagic{'T', 'A', 'L', 'S', 'T', 'R', 'I', 'P'};
inline constexpr std::uint32_t kVersion = 1;
inline constexpr std::uint64_t kHeaderBytes = 104, kPatchBytes = 12, kChecksumBytes = 8;
inline constexpr double kMostSteps = 0x1p51;  ///< whole numbers that a double holds, with room for the range
inline constexpr unsigned kNoType = 3;        ///< of entries that are no triangle

struct Patch {
  std::uint32_t first = 0;  ///< sub-strip
  GridPoint corner;         ///< north-west
};

/// Everything the header says.
struct Head {
  int height_bits = 0;
  GridRect region{{0, 0}, {-1, -1}}, window{{0, 0}, {-1, -1}};
  double step = 1;
  std::int64_t lowest = 0;
  std::uint64_t triangles = 0, runs = 0, sub_strips = 0, patches = 0;

  [[nodiscard]] std::uint64_t entries() const { return triangles + 2 * runs; }
  [[nodiscard]] unsigned entry_bits() const { return static_cast<unsigned>(height_bits) + 2; }
  [[nodiscard]] std::uint64_t data_bytes() const { return (entries() * entry_bits() + 7) / 8; }
  [[nodiscard]] std::uint64_t tail_bytes() const { return (runs + 1) / 2; }
  [[nodiscard]] std::uint64_t bytes() const {
    return kHeaderBytes + patches * kPatchBytes + sub_strips * 4 + tail_bytes() + data_bytes() + kChecksumBytes;
  }
};

/// Bits are counted in numbers of eight bytes, little endian in memory.
inline std::uint64_t little(std::uint64_t v) {
  if constexpr (std::endian::native == std::endian::big) v = __builtin_bswap64(v);
  return v;
}

}  // namespace talus::strip_layout
