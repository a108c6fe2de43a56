#pragma once
// An answer as one strip of triangles: a path that visits each triangle once, from one to the next over their shared
// edge. Also the strip as bits that a GPU can decode: docs/format/strip.md.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "talus/array.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// The edges over which the path enters and leaves a right triangle. The numbers are part of the format.
enum class StripType : std::uint8_t {
  a = 0,  ///< enters over one short side, leaves over the other
  b = 1,  ///< enters over a short side, leaves over the hypotenuse
  c = 2   ///< enters over the hypotenuse, leaves over a short side
};

/// One triangle of the path. Its corners, counter-clockwise seen from above: the left and the right end of the edge
/// where the path enters, and the corner ahead. A left turn leaves over the edge from the left end to the corner ahead.
struct StripStep {
  std::uint8_t bits = 0;  ///< the type, plus 4 for a right turn

  constexpr StripStep() = default;
  constexpr StripStep(StripType type, bool right)
      : bits(static_cast<std::uint8_t>(static_cast<int>(type) | (right ? 4 : 0))) {}
  [[nodiscard]] constexpr StripType type() const { return static_cast<StripType>(bits & 3); }
  [[nodiscard]] constexpr bool turns_right() const { return (bits & 4) != 0; }
  friend constexpr bool operator==(StripStep, StripStep) = default;
};

/// A run: triangles without a jump. The path jumps at the region's border and beside voids.
struct StripRun {
  std::uint64_t first = 0;            ///< number of its first triangle; it ends where the next run begins
  std::uint32_t left = 0, right = 0;  ///< vertices of the edge where the path enters that triangle
  friend constexpr bool operator==(const StripRun&, const StripRun&) = default;
};

/// A generalised triangle strip. After its first edge, a run needs one vertex and one bit (the turn) a triangle.
struct TriangleStrip {
  GridRect region{{0, 0}, {-1, -1}};  ///< the samples of the answer
  Array<GridPoint> points;            ///< numbered as in triangulate()
  Array<double> heights;              ///< of `points`, in the source's vertical unit
  Array<std::uint32_t> corners;       ///< by triangle: the corner ahead
  Array<StripStep> steps;             ///< by triangle
  std::vector<StripRun> runs;
  std::size_t swaps = 0;  ///< triangles with the same turn as the one before; GL_TRIANGLE_STRIP alternates

  [[nodiscard]] std::size_t triangles() const { return corners.size(); }
  [[nodiscard]] std::size_t indices() const { return corners.size() + 2 * runs.size(); }
  [[nodiscard]] std::size_t jumps() const { return runs.empty() ? 0 : runs.size() - 1; }
};

/// The strip of an answer: each triangle of triangulate() once, along a Sierpinski curve around the grid's origin.
///
/// quadtree  each vertex with its parents, as answers have them; from another set, the triangles that bisection reaches
/// fails     corrupt: the numbers of heights or covers do not match the vertices
/// cost      linear in triangles
/// source    [P98 §7], with triangles instead of squares; the path is the same
[[nodiscard]] TriangleStrip strip_of(const RestrictedQuadtree& quadtree);

/// The triangles of a strip in its order, counter-clockwise seen from above.
/// cost  linear
[[nodiscard]] Mesh mesh_of(const TriangleStrip& strip);

/// Indices for GL_TRIANGLE_STRIP. Every second triangle is reversed. A swap costs one more index, a jump two and the
/// next edge.
/// cost  linear
[[nodiscard]] Array<std::uint32_t> alternating_indices(const TriangleStrip& strip);

/// How a strip becomes bits.
struct StripCoding {
  /// In the source's vertical unit, > 0. Heights are rounded to multiples of it and move by at most half of it, so the
  /// coded surface is within the answer's bound plus half a step.
  double height_step = 1;
};

/// Sizes from the header of a coded strip.
struct StripSizes {
  std::uint64_t triangles = 0, runs = 0, sub_strips = 0, patches = 0;
  int height_bits = 0;
  std::uint64_t bytes = 0;  ///< the whole strip, headers and checksums included
};

/// A strip as bytes. A triangle needs two bits for its type and as many bits as the range of heights for the corner
/// ahead; every sixteen triangles, 32 bits let decoding begin there.
///
/// fails   invalid_argument: a step that is not positive; heights that are not finite or need more than 32 bits
/// cost    linear
/// source  [D09 §4]; there a strip fills a tile of 513² samples, here it has any extent and jumps
[[nodiscard]] std::vector<std::byte> encode_strip(const TriangleStrip& strip, const StripCoding& coding = {});

/// The triangles of a coded strip, in its order. Points occur once for each triangle that adds them, as on a GPU.
///
/// limit    most triangles; one byte can stand for two
/// threads  decode different sub-strips; 0: one a core. The mesh does not depend on it
/// fails    corrupt, with the position in bytes; unsupported: another version, or more triangles than the limit
/// cost     linear in triangles; memory about 30 bytes a triangle, at most 60
[[nodiscard]] Mesh decode_strip(std::span<const std::byte> bytes, int threads = 0,
                                std::uint64_t limit = std::uint64_t{1} << 30);

/// Reads the header and checks its checksum and sizes.
/// fails  as decode_strip
[[nodiscard]] StripSizes strip_sizes(std::span<const std::byte> bytes);

}  // namespace talus
