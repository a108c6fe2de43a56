#pragma once
// The inner loops of block errors, compiled once for each kind of processor.
//
// This header and engine/error/block_kernel.inc are all that those sources include: an inline function of any other
// header would be compiled with their instructions, and the linker might hand it to everybody.

#include <cstddef>
#include <cstdint>

namespace talus::detail {

inline constexpr int kBlockLevels = 6;  // spacings 1 … 32
inline constexpr int kBlockCells = 64;  // along a side of a block
inline constexpr int kBlockSamples = 65;
inline constexpr int kMostLanes = 32;

/// One of the blocks that go through together. All pointers are to what belongs to its north-west sample.
struct Lane {
  const void* heights = nullptr;
  std::ptrdiff_t stride = 0;
  const std::uint8_t* valid = nullptr;  ///< 1 where a sample counts; null: all do
  std::ptrdiff_t valid_stride = 0;
  /// By level: what is raised, at the block's vertices, and what the halves hold (null: all are data).
  std::uint16_t* errors[kBlockLevels] = {};
  const std::uint8_t* holds[kBlockLevels] = {};
  std::ptrdiff_t level_stride[kBlockLevels] = {};
  double margin = 0;     ///< metres on top of each error; where not 0 the caller sees to finest side midpoints himself
  float unit = 0;        ///< of `scaled_…`: a power of two of which all heights are multiples
  std::uint8_t odd = 0;  ///< 1: the block's own diagonal rises
};

/// From distances to codes. Whole numbers have distances in steps of 1 / (2 · spacing).
struct LadderTables {
  static constexpr int kShort = 2048;
  const std::uint16_t* steps[kBlockLevels] = {};  ///< kShort codes of 0, 1, 2 … steps by level
  double factor = 1, divisor = 1;                 ///< metres are distance · factor / divisor
  const double* rungs = nullptr;                  ///< metres of all codes, the last infinite
  const std::uint16_t* first_guess = nullptr;     ///< see ErrorLadder
};

struct Batch {
  const Lane* lanes = nullptr;
  int count = 0;           ///< of lanes in use
  bool masked = false;     ///< lanes have `valid` and `holds`
  void* memory = nullptr;  ///< kKernelMemory bytes, at 64
};

inline constexpr std::size_t kKernelCells = std::size_t{kBlockSamples} * kBlockSamples;
/// Memory of a batch: cells, masks and two planes of codes, 64 bytes each; then two of codes of real numbers, 16
/// each. Planes are zero where no vertex is, and stay so.
inline constexpr std::size_t kKernelPlane = 5718;
inline constexpr std::size_t kKernelRealPlanes = 64 * (2 * kKernelCells + 2 * kKernelPlane);
inline constexpr std::size_t kKernelMemory = kKernelRealPlanes + 16 * (2 * kKernelPlane) + 64 * 64;
/// Heights go through as whole numbers of 32 bits if they are below 2 to this power in their unit, and the unit's
/// exponent is within that of zero.
inline constexpr int kUnitBits = 29, kMostUnitExponent = 90;

/// The kBlockCells² samples a block owns, all there.
struct OwnSamples {
  const void* heights = nullptr;
  std::ptrdiff_t stride = 0;
  const std::uint8_t* valid = nullptr;  ///< 1 where a sample counts; null: all do
  std::ptrdiff_t valid_stride = 0;
};
/// How far samples lie from a plane, in floats: lowest and highest by squares of kSlabCells², lowest > highest where
/// no sample counts.
inline constexpr int kSlabCells = 8, kSlabsAcross = kBlockCells / kSlabCells;
struct SlabRanges {
  float low[kSlabsAcross * kSlabsAcross], high[kSlabsAcross * kSlabsAcross];
};
struct HeightRange {
  double lowest, highest;  ///< lowest > highest: no sample counts
};

/// Exponents of the lowest and of the highest bit that floats use. Zeros use none: lowest > highest.
struct BitsFound {
  int lowest, highest;
};

/// What is asked of the samples of a type.
struct ShapeKernel {
  HeightRange (*range)(const OwnSamples&);
  /// The highest sample not above a height, a number of the samples' type, and the lowest above it.
  HeightRange (*around)(const OwnSamples&, double height);
  /// The plane at the block's first sample, and its slopes.
  void (*slabs)(const OwnSamples&, const float (&plane)[3], SlabRanges&);
};

struct BlockKernel {
  const char* name;
  int whole_lanes, real_lanes;  ///< scaled numbers take those of whole ones
  /// Raises errors by those of blocks of 16-bit whole numbers, of floats and of doubles.
  void (*whole)(const Batch&, const LadderTables&);
  void (*floats)(const Batch&, const LadderTables&);
  void (*doubles)(const Batch&, const LadderTables&);
  /// Of floats and doubles that are multiples of their lane's unit. Returns a bit for each lane whose heights lie too
  /// far apart for that: nothing of it was raised.
  std::uint32_t (*scaled_floats)(const Batch&, const LadderTables&);
  std::uint32_t (*scaled_doubles)(const Batch&, const LadderTables&);
  ShapeKernel whole_shape, floats_shape, doubles_shape;
  /// Of a rectangle. Right if lowest > -150 and highest < 128; else there may be denormals, or what is no number.
  BitsFound (*bits)(const float* heights, std::ptrdiff_t stride, int cols, int rows);
  /// How far samples of each slab can be from another plane: `first` apart at the first slab's middle, that much more
  /// per slab to the right and down. `slack` is added.
  void (*bounds)(const SlabRanges&, float first, float right, float down, float slack, float* bounds);
  /// Raises errors where halves are mixed, side 0 in the lower two bits of `holds`, side 1 above: by the code for the
  /// parity of the place and the side.
  void (*raise_mixed)(std::uint16_t* errors, const std::uint8_t* holds, int count, const std::uint16_t (&codes)[2][2]);
  /// Saturation of one row: raises those of `count` values that stand at an odd distance from the first by their four
  /// neighbours; the first and the last have none and stay.
  void (*raise_by_neighbours)(std::uint16_t* row, const std::uint16_t* above, const std::uint16_t* below, int count);
  /// Raises every second of `count` values, value i by the values 2i - 1 and 2i + 1 above and below.
  void (*raise_by_corners)(std::uint16_t* row, const std::uint16_t* above, const std::uint16_t* below, int count);
};

}  // namespace talus::detail
