#pragma once
// The numbers of a page's square as bytes: grouped Rice codes.
//
// Sixteen numbers that follow each other in a row are a group. How uneven the ground around a group is gives its class,
// which reader and writer both know; the page says for each class how many low bits a number has. The rest of a number
// is unary. All unary parts of a page are one stream of bits, all low bits another, so a reader finds the ends of all
// unary parts before it knows any number.
//
// A bend counts in units of 2 to the power of the page's bend shift, rounded up, and as 255 at most. A number that is
// listed apart has residual 0 in the streams; it takes its place at the end of its pass (a spacing's centres, or its
// side midpoints), and the list is in the order of passes.
//
// The bytes: bend shift (1), least number of low bits (1), numbers that are listed apart (2), bytes of unary parts (2)
// and of flags (2), a bit for each class whose groups have flags (4), low bits of 26 classes beyond the least number (4
// bits each), the listed numbers (place 2, number 2 to 8), flags, unary parts, low bits. Little endian, lowest bits
// first. Bytes of flags 65535: there are none, and all flags are 1, as where the ground is flat.
//
// source  Rice codes: R. F. Rice, JPL 79-22, 1979; grouping and two streams: ours (docs/decisions/0012-dense-pages.md)

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/dense/dense_kernel.hpp"
#include "engine/dense/square_bits.hpp"

namespace talus {

/// Writes and reads the numbers of squares, reusing its memory. T: std::uint16_t, std::uint32_t or std::uint64_t;
/// arithmetic wraps around, and only differences count.
template <class T>
class DenseNumbers {
 public:
  DenseNumbers();
  /// With other functions than the fastest of this processor; for tests.
  explicit DenseNumbers(const detail::DenseFunctions<T>& functions);
  ~DenseNumbers();
  DenseNumbers(DenseNumbers&&) noexcept;
  DenseNumbers& operator=(DenseNumbers&&) noexcept;

  /// Appends the numbers at all places but those where column and row are multiples of 8: the reader knows these. A
  /// number that is not stored becomes what the reader will have.
  ///
  /// stored  which numbers are stored; null: all
  /// cost    about 5 ns a number
  void put(std::span<T> square, const SquareBits* stored, std::vector<std::byte>& out);

  /// Reads all that put() appended.
  ///
  /// square   has the numbers at multiples of 8
  /// returns  false: no such bytes; the square has no meaning
  /// cost     about 0.6 ns a number of 16 bits with AVX-512, 0.8 with AVX2, 2.5 without
  [[nodiscard]] bool get(std::span<const std::byte> bytes, const SquareBits* stored, std::span<T> square);

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace talus
