#pragma once
// Errors in eighths that do not follow from the heights of a page, as bytes.
//
// A saturated error is at least that of each of its children and, beside data, the distance of the vertex from the
// middle of its ends. Most stored errors are exactly the largest of these, so each has a bit that says whether it is
// more, and only then a number. Errors are at most 32767; distances are those of heights that wrap around in 16 bits.
//
// The bytes: low bits of six levels (4 bits each: spacing 1, 2, 4, side midpoints before centres), the bits of all
// vertices, then the numbers, less 1, as Rice codes. A code of 24 zeros is followed by 15 bits: the number itself.
// Lowest bits first. Vertices come by level, row by row. If all are exactly that, one byte 15 is everything.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/dense/eighths_kernel.hpp"
#include "engine/dense/square_bits.hpp"

namespace talus {

/// Writes and reads the stored errors of squares.
class StoredEighths {
 public:
  /// For squares with these samples. Of those of spacing 1, 2 and 4 an error is stored that implied_places() lacks.
  ///
  /// present  samples in the raster
  /// data     those of them that are data, whose heights count
  StoredEighths(const SquareBits& present, const SquareBits& data);

  /// Appends the stored errors. An error that is smaller than the least possible one counts as that, and becomes it.
  ///
  /// square   128² numbers row by row
  /// errors   those of all present vertices of spacing 1, 2 and 4
  /// returns  whether all were possible
  bool put(std::span<const std::int16_t> square, detail::SortedSquare& errors, std::vector<std::byte>& out) const;
  /// Reads what put() appended from the beginning of `bytes`.
  ///
  /// errors   has all implied errors
  /// returns  the bytes that were read; 0: no such bytes, or an error beyond 16 bits. One byte at least is read
  [[nodiscard]] std::size_t get(std::span<const std::byte> bytes, std::span<const std::int16_t> square,
                                detail::SortedSquare& errors) const;

  [[nodiscard]] std::size_t count() const { return vertices_.size(); }

 private:
  static constexpr int kLevels = 6;  ///< three spacings, side midpoints and centres
  struct Vertex {
    std::int16_t error;                ///< its place in errors, see SortedSquare
    std::int16_t at;                   ///< in the square
    std::int16_t to_end;               ///< from there to one end, and backward to the other; 0: they do not count
    std::uint8_t level, children = 0;  ///< number of children that are present
    std::int16_t child[4] = {};        ///< their places in errors
  };
  [[nodiscard]] static int least(const Vertex& v, const std::int16_t* square, const std::int16_t* errors);

  std::vector<Vertex> vertices_;  ///< children before their parents
};

}  // namespace talus
