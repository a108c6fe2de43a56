#pragma once
// Triangles and sub-strip headers of coded strips: docs/format/strip.md.

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "engine/quadtree/grid.hpp"
#include "talus/strip.hpp"

namespace talus {

inline constexpr std::uint64_t kSubStrip = 16;   ///< triangles of a sub-strip; fewer at the end of a run
inline constexpr std::int32_t kPatchSide = 512;  ///< cells: columns and rows in a patch need nine bits
inline constexpr int kMostHeightBits = 32;

/// The turn of the next triangle. In a strip made by bisection it follows from the types: type A keeps the turn, the
/// other types reverse it once on the hypotenuse. {AL BR CL} can follow AL, BL and CR; {AR BL CR} the other three.
///
/// source  [D09 §4.1 and appendix, table 1], as one exclusive or
[[nodiscard]] constexpr bool turn_behind(StripStep before, StripType type) {
  return before.turns_right() != ((before.type() == StripType::c) != (type == StripType::b));
}

/// The corner ahead of the edge from `left` to `right`; empty if it lies between samples.
[[nodiscard]] constexpr std::optional<GridPoint> corner_ahead(GridPoint left, GridPoint right, StripStep step) {
  // Rows count south: seen from above, (col, row) turned left by a right angle is (row, -col).
  const std::int64_t dc = std::int64_t{right.col} - left.col, dr = std::int64_t{right.row} - left.row;
  std::int64_t col = left.col, row = left.row;
  if (step.type() == StripType::c) {
    if (((dc + dr) & 1) != 0) return std::nullopt;
    col += (dc + dr) / 2;
    row += (dr - dc) / 2;
  } else {
    const bool at_left = (step.type() == StripType::a) != step.turns_right();  // position of the right angle
    col += dr + (at_left ? 0 : dc);
    row += -dc + (at_left ? 0 : dr);
  }
  if (col < INT32_MIN || col > INT32_MAX || row < INT32_MIN || row > INT32_MAX) return std::nullopt;
  return GridPoint{static_cast<std::int32_t>(col), static_cast<std::int32_t>(row)};
}

/// The start of a sub-strip. Its edge runs along an axis or a diagonal, over 2^log cells. One end of it is the newest
/// entry before the first triangle, the other one is two to nine entries back.
///
/// source  [D09 §4.2, fig. 6], with one bit more for the length (answers larger than a tile) and one for jumps
struct SubStripHeader {
  std::uint32_t col = 0, row = 0;  ///< position of the left end in its patch
  int log = 0;
  int direction = 0;  ///< from the left end to the right one, in eighths of a turn counter-clockwise from east
  int offset = 2;     ///< how many entries the older end is back
  bool older_is_right = false;
  bool turns_right = false;  ///< turn of its first triangle
  bool begins_run = false;   ///< two entries with the heights of its edge stand before its first triangle

  [[nodiscard]] constexpr std::uint32_t pack() const {
    return col | row << 9 | static_cast<std::uint32_t>(log) << 18 | static_cast<std::uint32_t>(direction) << 23 |
           static_cast<std::uint32_t>(offset - 2) << 26 | (older_is_right ? 1u << 29 : 0u) |
           (turns_right ? 1u << 30 : 0u) | (begins_run ? 1u << 31 : 0u);
  }
  [[nodiscard]] static constexpr SubStripHeader unpack(std::uint32_t bits) {
    return {bits & 511,
            bits >> 9 & 511,
            static_cast<int>(bits >> 18 & 31),
            static_cast<int>(bits >> 23 & 7),
            static_cast<int>(bits >> 26 & 7) + 2,
            (bits >> 29 & 1) != 0,
            (bits >> 30 & 1) != 0,
            bits >> 31 != 0};
  }
  friend constexpr bool operator==(const SubStripHeader&, const SubStripHeader&) = default;
};

/// One step in a direction.
struct Heading {
  int col, row;
};
inline constexpr Heading kHeadings[8] = {{1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}, {0, 1}, {1, 1}};

/// Sets direction and length of an edge; false if no triangle of the hierarchy has such an edge.
[[nodiscard]] constexpr bool name_edge(GridPoint left, GridPoint right, SubStripHeader& header) {
  const std::int64_t dc = std::int64_t{right.col} - left.col, dr = std::int64_t{right.row} - left.row;
  const std::int64_t across = dc < 0 ? -dc : dc, down = dr < 0 ? -dr : dr, length = across > down ? across : down;
  if (length == 0 || (across != 0 && down != 0 && across != down)) return false;
  if (!std::has_single_bit(static_cast<std::uint64_t>(length))) return false;
  header.log = std::countr_zero(static_cast<std::uint64_t>(length));
  for (int i = 0; i < 8; ++i) {
    if (kHeadings[i].col * length == dc && kHeadings[i].row * length == dr) header.direction = i;
  }
  return true;
}

}  // namespace talus

/// The header and the bits of coded strips: docs/format/strip.md.
namespace talus::strip_layout {

inline constexpr std::array<char, 8> kMagic{'T', 'A', 'L', 'S', 'T', 'R', 'I', 'P'};
inline constexpr std::uint32_t kVersion = 1;
inline constexpr std::uint64_t kHeaderBytes = 104, kPatchBytes = 12, kChecksumBytes = 8;
inline constexpr double kMostSteps = 0x1p51;  ///< a double holds whole numbers up to this, with room for the range
inline constexpr unsigned kNoType = 3;        ///< type of an entry that is not a triangle

struct Patch {
  std::uint32_t first = 0;  ///< its first sub-strip
  GridPoint corner;         ///< north-west corner
};

/// The header of a coded strip.
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

/// Bits are read in words of eight bytes, little endian in memory.
inline std::uint64_t little(std::uint64_t v) {
  if constexpr (std::endian::native == std::endian::big) v = __builtin_bswap64(v);
  return v;
}

}  // namespace talus::strip_layout
