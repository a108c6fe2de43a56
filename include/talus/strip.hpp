#pragma once
// An answer as one strip of triangles: a path that visits every triangle once and goes on over the edge it shares with
// the next. And the same strip as bits, for a GPU that decodes it: docs/format/strip.md.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "talus/array.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Over which edges the path comes into a right triangle and leaves it. The numbers are those of the bytes.
enum class StripType : std::uint8_t {
  a = 0,  ///< from one side at the right angle to the other
  b = 1,  ///< from such a side to the hypotenuse
  c = 2   ///< from the hypotenuse to such a side
};

/// What the path does in one triangle. Its corners are, counter-clockwise seen from above: the left and the right end
/// of the edge it comes in by, and the corner ahead. It turns left and leaves between the left end and the corner
/// ahead, or right.
struct StripStep {
  std::uint8_t bits = 0;  ///< the type, and 4 for right

  constexpr StripStep() = default;
  constexpr StripStep(StripType type, bool right)
      : bits(static_cast<std::uint8_t>(static_cast<int>(type) | (right ? 4 : 0))) {}
  [[nodiscard]] constexpr StripType type() const { return static_cast<StripType>(bits & 3); }
  [[nodiscard]] constexpr bool turns_right() const { return (bits & 4) != 0; }
  friend constexpr bool operator==(StripStep, StripStep) = default;
};

/// Triangles that follow each other without a jump, up to the next run: at the region's border and beside voids a path
/// ends and goes on elsewhere.
struct StripRun {
  std::uint64_t first = 0;            ///< triangle
  std::uint32_t left = 0, right = 0;  ///< vertices: the edge by which the path comes into it
  friend constexpr bool operator==(const StripRun&, const StripRun&) = default;
};

/// A generalised triangle strip: after its first edge a run takes one vertex a triangle, and one bit, which way it
/// turns.
struct TriangleStrip {
  GridRect region{{0, 0}, {-1, -1}};  ///< the outermost sample positions answered
  Array<GridPoint> points;            ///< with the same numbers as in triangulate()
  Array<double> heights;              ///< of points, in the source's vertical unit
  Array<std::uint32_t> corners;       ///< by triangle: the vertex ahead
  Array<StripStep> steps;             ///< by triangle
  std::vector<StripRun> runs;
  std::size_t swaps = 0;  ///< triangles that turn as the one before them did, where a plain strip alternates

  [[nodiscard]] std::size_t triangles() const { return corners.size(); }
  [[nodiscard]] std::size_t indices() const { return corners.size() + 2 * runs.size(); }
  [[nodiscard]] std::size_t jumps() const { return runs.empty() ? 0 : runs.size() - 1; }
};

/// The strip of an answer: the triangles of triangulate(), each once, along a Sierpinski curve around the grid's
/// origin.
///
/// quadtree  closed under parents, as answers are. Of any other set: the triangles that bisection finds from the root
/// fails     corrupt: as many heights or covers as do not fit the vertices
/// cost      linear in triangles; those that only bisection meets on its way are fewer, and along the border few more
/// source    [P98 §7]: there squares of a quadtree, here triangles; the same path
[[nodiscard]] TriangleStrip strip_of(const RestrictedQuadtree& quadtree);

/// The triangles of a strip, in its order, counter-clockwise seen from above.
/// cost  linear
[[nodiscard]] Mesh mesh_of(const TriangleStrip& strip);

/// One list of indices for hardware that alternates turns and knows neither swaps nor jumps (GL_TRIANGLE_STRIP): every
/// second triangle is turned round, a swap takes one vertex more, a jump two and the edge behind it.
/// cost  linear
[[nodiscard]] Array<std::uint32_t> alternating_indices(const TriangleStrip& strip);

/// How a strip becomes bits.
struct StripCoding {
  /// Heights become whole multiples of it, so they move by at most half of it; those that are such multiples stay. In
  /// the source's vertical unit, > 0. An answer and its bits lie within its bound plus half a step.
  double height_step = 1;
};

/// What the header of a coded strip says, for those who compare.
struct StripSizes {
  std::uint64_t triangles = 0, runs = 0, sub_strips = 0, patches = 0;
  int height_bits = 0;
  std::uint64_t bytes = 0;  ///< all of it, headers and checksums included
};

/// A strip as bytes: two bits a triangle for its type and as many as the range of heights needs for the vertex ahead;
/// every sixteen triangles 32 bits with which decoding can begin there.
///
/// fails   invalid_argument: a step that is not positive, heights that are not finite or take more than 32 bits
/// cost    linear
/// source  [D09 §4]: its strips cover a tile of 513² samples, ours an answer of any extent, with jumps
[[nodiscard]] std::vector<std::byte> encode_strip(const TriangleStrip& strip, const StripCoding& coding = {});

/// The triangles of a strip, in its order. Points occur once for each triangle that came to them: they are what a GPU
/// gets, not an indexed mesh of least size.
///
/// limit    triangles at most, of which two may stand in one byte
/// threads  decode different sub-strips; 0: one a core. Changes nothing but the time
/// fails    corrupt, with the byte where it shows; unsupported: another version, or more triangles than the limit
/// cost     linear in triangles; memory about 30 bytes a triangle, and 60 at worst
[[nodiscard]] Mesh decode_strip(std::span<const std::byte> bytes, int threads = 0,
                                std::uint64_t limit = std::uint64_t{1} << 30);

/// What the header says, its checksum and all sizes checked.
/// fails  as decode_strip
[[nodiscard]] StripSizes strip_sizes(std::span<const std::byte> bytes);

}  // namespace talus
