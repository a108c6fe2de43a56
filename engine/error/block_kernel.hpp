#pragma once
// The inner loops of block errors, compiled once for each kind of processor.
//
// Their sources include only this header and engine/error/block_kernel.inc. An inline function of another header would
// be compiled with their instructions too, and the linker might use that version everywhere.

#include <cstddef>
#include <cstdint>

namespace talus::detail {

inline constexpr int kBlockLevels = 6;  // spacings 1 … 32
inline constexpr int kBlockCells = 64;  // along a side of a block
inline constexpr int kBlockSamples = 65;
inline constexpr int kMostLanes = 32;

/// One block of a batch. All pointers point to the entry of its north-west sample.
struct Lane {
  const void* heights = nullptr;
  std::ptrdiff_t stride = 0;
  const std::uint8_t* valid = nullptr;  ///< 1: the sample counts; null: all count
  std::ptrdiff_t valid_stride = 0;
  /// By level, for the block's vertices: errors to raise, and what the halves hold (null: all are data).
  std::uint16_t* errors[kBlockLevels] = {};
  const std::uint8_t* holds[kBlockLevels] = {};
  std::ptrdiff_t level_stride[kBlockLevels] = {};
  double margin = 0;     ///< metres to add to each error; if not 0, the caller computes finest side midpoints
  float unit = 0;        ///< for `scaled_…`: a power of two; all heights are multiples of it
  std::uint8_t odd = 0;  ///< 1: the block's own diagonal rises
};

/// Tables from distances to codes. Distances of whole numbers are multiples of a step, 1 / (2 · spacing).
struct LadderTables {
  static constexpr int kShort = 2048;
  const std::uint16_t* steps[kBlockLevels] = {};  ///< by level: the codes of 0 … kShort - 1 steps
  double factor = 1, divisor = 1;                 ///< metres = distance · factor / divisor
  const double* rungs = nullptr;                  ///< metres of all codes, the last one infinite
  const std::uint16_t* first_guess = nullptr;     ///< see ErrorLadder
};

struct Batch {
  const Lane* lanes = nullptr;
  int count = 0;           ///< lanes in use
  bool masked = false;     ///< lanes have `valid` and `holds`
  void* memory = nullptr;  ///< kKernelMemory bytes, aligned to 64
};

inline constexpr std::size_t kKernelCells = std::size_t{kBlockSamples} * kBlockSamples;
/// Memory of a batch: cells, masks and two planes of codes, 64 bytes each; then two planes of codes of real numbers, 16
/// each. Entries without a vertex are always zero.
inline constexpr std::size_t kKernelPlane = 5718;
inline constexpr std::size_t kKernelRealPlanes = 64 * (2 * kKernelCells + 2 * kKernelPlane);
inline constexpr std::size_t kKernelMemory = kKernelRealPlanes + 16 * (2 * kKernelPlane) + 64 * 64;
/// Heights can be whole numbers of 32 bits if in their unit they are below 2 to this power, and the unit's exponent is
/// within kMostUnitExponent of zero.
inline constexpr int kUnitBits = 29, kMostUnitExponent = 90;

/// The kBlockCells² samples that a block owns, all inside the field.
struct OwnSamples {
  const void* heights = nullptr;
  std::ptrdiff_t stride = 0;
  const std::uint8_t* valid = nullptr;  ///< 1: the sample counts; null: all count
  std::ptrdiff_t valid_stride = 0;
};
/// Lowest and highest distance of samples from a plane, for each square of kSlabCells²; lowest > highest: no sample
/// counts.
inline constexpr int kSlabCells = 8, kSlabsAcross = kBlockCells / kSlabCells;
struct SlabRanges {
  float low[kSlabsAcross * kSlabsAcross], high[kSlabsAcross * kSlabsAcross];
};
struct HeightRange {
  double lowest, highest;  ///< lowest > highest: no sample counts
};

/// Exponents of the lowest and highest bit that floats use. Zeros use none: lowest > highest.
struct BitsFound {
  int lowest, highest;
};

/// Functions over samples of one type.
struct ShapeKernel {
  HeightRange (*range)(const OwnSamples&);
  /// The highest sample that is not above a height, and the lowest one above it.
  HeightRange (*around)(const OwnSamples&, double height);
  /// The plane is its value at the block's first sample, and its slopes.
  void (*slabs)(const OwnSamples&, const float (&plane)[3], SlabRanges&);
};

struct BlockKernel {
  int whole_lanes, real_lanes;  ///< blocks in a batch; scaled numbers have as many as whole ones
  /// Raise the errors of blocks of 16-bit whole numbers, floats, doubles.
  void (*whole)(const Batch&, const LadderTables&);
  void (*floats)(const Batch&, const LadderTables&);
  void (*doubles)(const Batch&, const LadderTables&);
  /// The same for floats and doubles that are multiples of their lane's unit. Returns a bit for each lane whose heights
  /// lie too far apart for that; its errors are unchanged.
  std::uint32_t (*scaled_floats)(const Batch&, const LadderTables&);
  std::uint32_t (*scaled_doubles)(const Batch&, const LadderTables&);
  ShapeKernel whole_shape, floats_shape, doubles_shape;
  /// The bits of a rectangle. Valid if lowest > -150 and highest < 128; else there may be denormals, infinity or NaN.
  BitsFound (*bits)(const float* heights, std::ptrdiff_t stride, int cols, int rows);
  /// Upper bounds of the distance of each slab's samples from another plane. The planes are `first` apart in the middle
  /// of the first slab; `right` and `down` are the changes per slab. `slack` is added.
  void (*bounds)(const SlabRanges&, float first, float right, float down, float slack, float* bounds);
  /// Raises errors where halves are mixed (bits 0 and 1 of `holds`: side 0; bits 2 and 3: side 1) to the code for the
  /// parity of the position and the side.
  void (*raise_mixed)(std::uint16_t* errors, const std::uint8_t* holds, int count, const std::uint16_t (&codes)[2][2]);
  /// Saturates one row: raises every second of `count` values, from the second on, to the largest of its four
  /// neighbours. The first and the last value stay.
  void (*raise_by_neighbours)(std::uint16_t* row, const std::uint16_t* above, const std::uint16_t* below, int count);
  /// Raises every second of `count` values: value i by the values 2i - 1 and 2i + 1 above and below.
  void (*raise_by_corners)(std::uint16_t* row, const std::uint16_t* above, const std::uint16_t* below, int count);
};

}  // namespace talus::detail
