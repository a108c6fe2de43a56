#pragma once
// The inner loops of the triangulation by words, compiled once for each set of instructions.
//
// Their sources include only this header and engine/quadtree/triangle_kernel.inc. An inline function of another header
// would be compiled with their instructions too, and the linker might use that version everywhere.

#include <cstddef>
#include <cstdint>

namespace talus::detail {

/// Vertices of larger spacing are left to the caller: a word holds at most one column of theirs.
inline constexpr int kMostWordSpacing = 32;
/// The kernel may write this many triangles beyond the last one.
inline constexpr std::size_t kWrittenAhead = 16;

/// A vertex mask as plain numbers.
struct MaskRows {
  const std::uint64_t* words = nullptr;   ///< row by row; bits beyond the last column are 0
  const std::uint32_t* before = nullptr;  ///< the rank of the first bit of each word
  const std::uint8_t* covers = nullptr;   ///< by rank, as RestrictedQuadtree::covers; null: all triangles hold data
  std::int64_t words_per_row = 0;
  std::int32_t first_col = 0, first_row = 0, last_col = 0, last_row = 0;
};

/// All work on the vertices of spacing 1 … kMostWordSpacing of one row.
struct TriangleKernel {
  /// Writes the leaves around them, three vertex numbers each, counter-clockwise. Their order depends on nothing but
  /// the mask. There must be room for four triangles a vertex of the row and kWrittenAhead. `closed` becomes false if a
  /// corner of a triangle is in the mask's rectangle but not in the mask.
  /// returns  the end of the triangles
  std::uint32_t* (*leaves)(const MaskRows& mask, std::int32_t row, std::uint32_t* out, bool& closed);
  /// The number of triangles that `leaves` writes.
  std::size_t (*count_leaves)(const MaskRows& mask, std::int32_t row);
  /// Writes column and row of each vertex of the row, and numbers beyond them up to `room_end`.
  void (*points)(const MaskRows& mask, std::int32_t row, std::uint32_t* out, const std::uint32_t* room_end);
};

}  // namespace talus::detail
