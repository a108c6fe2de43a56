#pragma once
// Errors that follow from a page's heights, in eighths of a height code and 16 bits, the vertices above a threshold,
// and their heights: compiled once for each kind of processor.
//
// Its sources include only this header and engine/dense/eighths_kernel.inc. An inline function of another header would
// be compiled with their instructions too, and the linker might use that version everywhere.

#include <cstddef>
#include <cstdint>

namespace talus::detail {

/// A square of 128² numbers, sorted so that a vector holds the same place of 32 blocks of 8²: row by row of the upper
/// half, the eight places of a column in its block, then the sixteen blocks of that row and the sixteen of the row 64
/// below. Some rows around each half belong to the other one, or to nobody.
struct SortedSquare {
  static constexpr int kPlaces = 8, kBlocks = 16, kLanes = 2 * kBlocks, kRows = 64, kAround = 12;
  static constexpr int kRow = kPlaces * kLanes;  ///< numbers
  alignas(64) std::int16_t numbers[(kRows + 2 * kAround) * kRow + 128];

  /// Row 0 is the first one of the upper half, and lane 16 of it row 64 of the square.
  [[nodiscard]] static constexpr int index(int row, int place, int lane) {
    return 64 + ((row + kAround) * kPlaces + place) * kLanes + lane;
  }
  [[nodiscard]] static constexpr int index_of(int col, int row) {
    return index(row & (kRows - 1), col & (kPlaces - 1), (row / kRows) * kBlocks + col / kPlaces);
  }
};

/// A part of a square: columns first_col to last_col, rows alike.
struct SquarePart {
  int first_col = 0, last_col = 127, first_row = 0, last_row = 127;
};

/// The largest errors in a part of a square; -1: none.
struct EighthsFound {
  std::int16_t largest_absent = -1;                 ///< of those that are not above the threshold
  std::int16_t largest_selected[3] = {-1, -1, -1};  ///< of the others, by spacing: 1, 2, 4
};

struct EighthsKernel {
  /// Computes the saturated errors of all vertices of spacing 1, 2 and 4, of which those are right that depend on
  /// samples of the square only (is_implied_by_place), if 16 bits hold all differences between their samples and
  /// planes, and eight times any slope.
  ///
  /// square   128² numbers row by row
  /// errors   those of samples of spacing 8 have no meaning
  /// heights  memory to work in; receives the square in eighths
  void (*compute)(const std::int16_t* square, SortedSquare& errors, SortedSquare& heights);
  /// Sets the bits of the samples in `part` whose errors are above the threshold, and clears those of all others.
  EighthsFound (*select)(const SortedSquare& errors, std::int16_t threshold, const SquarePart& part,
                         std::uint64_t (*rows)[2]);
  /// Writes the numbers of a square whose bits are set, row by row, and returns how many. Up to 32 more are written.
  int (*gather)(const std::int16_t* square, const std::uint64_t (*rows)[2], std::int16_t* to);
};

}  // namespace talus::detail
