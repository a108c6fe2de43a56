#pragma once
// The numbers of a dense page, between bytes and memory: compiled once for each kind of processor.
//
// Its sources include only this header and engine/dense/dense_kernel.inc. An inline function of another header would be
// compiled with their instructions too, and the linker might use that version everywhere.

#include <cstddef>
#include <cstdint>

namespace talus::detail {

inline constexpr int kDenseSide = 128;   ///< numbers along a square's side
inline constexpr int kDenseLevels = 3;   ///< spacings 4, 2 and 1
inline constexpr int kKnownAcross = 16;  ///< numbers of spacing 8 along a side
inline constexpr int kGroup = 16;        ///< numbers that share a parameter
inline constexpr int kDenseNumbers = kDenseSide * kDenseSide - kKnownAcross * kKnownAcross;
inline constexpr int kDenseGroups = kDenseNumbers / kGroup;  ///< of a square
inline constexpr int kBendClasses = 26, kBendSums = 16 * 255 + 1;
inline constexpr std::uint8_t kFlagged = 128;  ///< added in DenseStreams::low_bits_of

/// The class of a sum of bends: 0 for none, then two an octave.
constexpr int bend_class(unsigned sum) {
  if (sum == 0) return 0;
  const int high = 31 - __builtin_clz(sum);
  return 1 + 2 * high + (high > 0 ? static_cast<int>(sum >> (high - 1) & 1) : 0);
}
static_assert(bend_class(kBendSums - 1) < kBendClasses);

/// Where a table by sum of bends has its entry. From 64 on, classes begin at multiples of 32.
inline constexpr std::size_t kBendPlaces = 64 + kBendSums / 32 + 1;
constexpr std::size_t bend_place(unsigned sum) { return sum < 64 ? sum : 64 + (sum >> 5); }

/// The parts of a dense page. Behind `flags` at least kDenseGroups / 8 + 8 bytes can be read, behind `low` 1 KiB.
struct DenseStreams {
  const std::uint8_t *unary = nullptr, *flags = nullptr, *low = nullptr;
  std::size_t unary_bytes = 0, flag_bytes = 0, low_bytes = 0;
  bool all_flagged = false;                     ///< all flags are 1, however many there are
  const std::uint16_t* patched = nullptr;       ///< places in the square, in coding order
  const std::uint64_t* patch_values = nullptr;  ///< what they are
  std::size_t patches = 0;
  int bend_shift = 2;                          ///< bends are counted in units of 2 to this power
  std::uint8_t low_bits_of[kBendPlaces] = {};  ///< by bend_place(): bits, and whether groups have flags
  /// By row of the square, the samples whose numbers are stored, 64 a word; null: all.
  const std::uint64_t (*stored)[2] = nullptr;
};

/// For writing: the differences between numbers and predictions, zigzag, in coding order.
template <class T>
struct Residuals {
  T zigzag[kDenseNumbers];
  std::uint16_t bend_sums[kDenseGroups];  ///< by group
  std::uint16_t stored[kDenseGroups];     ///< by group, a bit for each number that is stored
};

/// What reading and writing work in: grids of one level with a rim.
template <class T>
struct alignas(64) DenseMemory {
  static constexpr int kRim = 64 / sizeof(T), kStride = kRim + 64;
  T even[kStride * 67 + kRim], centres[kStride * 67 + kRim];
  T along[64 * 64 + kRim], down[64 * 64 + kRim];
  T bends[8][2][kStride + kRim];
  std::uint8_t ones[64 + kDenseNumbers + 64];  ///< positions of ones, modulo 256
};

/// The functions for numbers of one width. A square has kDenseSide² numbers row by row; those of spacing 8 are known.
template <class T>
struct DenseFunctions {
  /// Reads all other numbers. A number that is not stored becomes its prediction. Returns whether the streams have
  /// exactly the bits that this takes; if not, the numbers have no meaning.
  bool (*read)(const DenseStreams&, T* square, DenseMemory<T>&);
  /// Predicts all other numbers, and gives those that are not stored their prediction.
  void (*predict)(T* square, const std::uint64_t (*stored)[2], int bend_shift, DenseMemory<T>&, Residuals<T>&);
};

struct DenseKernel {
  DenseFunctions<std::uint16_t> narrow;
  DenseFunctions<std::uint32_t> wide;
};

}  // namespace talus::detail
