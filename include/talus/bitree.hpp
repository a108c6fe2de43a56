#pragma once
// Bitrees: the other way to close a mesh. Each triangle is split alone, and where it meets finer ones a vertex is made
// up. Talus has them to compare them with the restricted quadtree: docs/formats-compared.md.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "talus/array.hpp"
#include "talus/description.hpp"
#include "talus/quadtree.hpp"
#include "talus/units.hpp"

namespace talus {

/// A hierarchy of right triangles in which the two triangles of a diamond may be split one without the other.
///
/// A *selected* vertex has the source's height and splits both triangles of its diamond. A *fictitious* vertex exists
/// because a finer triangle needs it. Its height is halfway between the ends of its diamond, so it lies on the side of
/// the other triangle. Fictitious vertices follow from the selected ones, so nobody has to send them.
struct Bitree {
  // Bits of `kinds`. The first half of a diamond has bits 0 and 1 of RestrictedQuadtree::covers, the second 2 and 3.
  static constexpr std::uint8_t kSplitsFirst = 1;
  static constexpr std::uint8_t kSplitsSecond = 2;
  static constexpr std::uint8_t kSelected = 4;

  GridRect region{{0, 0}, {-1, -1}};
  VertexMask vertices;               ///< over the region, sealed
  std::vector<std::uint8_t> kinds;   ///< by rank
  Array<double> heights;             ///< by rank, in the source's vertical unit
  std::vector<std::uint8_t> covers;  ///< by rank, as RestrictedQuadtree::covers; empty: every triangle holds data
  Metres tolerance;                  ///< as asked
  /// No covered sample is farther from the surface. The tolerance, plus some nanometres where heights are not binary
  /// fractions. Infinite if not verified.
  Metres bound;
  std::size_t selected = 0;   ///< number of selected vertices
  std::size_t corrected = 0;  ///< selected vertices that verification added, to keep all samples within the tolerance

  [[nodiscard]] std::size_t fictitious() const { return vertices.size() - selected; }
};

struct BitreeOptions {
  double metres_per_unit = 1;  ///< metres in one unit of height
  /// The longer side of a cell on the ground, and `void_weight` metres of error a metre of ground. A triangle with data
  /// and voids is split while its longest side times the weight is above the tolerance.
  Metres cell{1};
  double void_weight = 1;
  /// Measure what fictitious vertices do to the surface. False: as published, without a bound.
  bool verified = true;
};

/// The bitree of a rectangle of samples. It selects the vertices with an error above the tolerance, the vertices that
/// the region's sides need, and those whose fictitious height leaves a covered sample farther off than the tolerance.
///
/// Voids are treated as in Snapshot::ask: a triangle is there if it holds a valid finest one, and a selected void
/// vertex has the height of a sample nearby. Bitrees of neighbouring regions need not meet.
///
/// samples    values and valid for the whole region, row by row
/// tolerance  metres, >= 0; infinity is allowed
/// fails      invalid_argument: sizes that do not match the region, a tolerance that is negative or NaN, a valid height
///            that is not finite, options that are not positive
/// cost       time: samples times levels for the errors, then triangles and the samples under fictitious vertices for
///            each round of verification; memory: 9 bytes a sample, 19 with voids
/// source     [A §2.2, §3.2]; verification: ours
[[nodiscard]] Bitree bitree_of(const SampleWindow& samples, Metres tolerance, const BitreeOptions& options = {});

/// The bitree with these selected vertices: adds fictitious vertices and their heights.
///
/// selected  over the region, sealed, with the vertices that its sides need
/// heights   by rank
/// returns   a bitree without covers; its bound is infinite, because it is made without samples
/// fails     invalid_argument: not one height a vertex; a border vertex is missing
/// cost      linear in the region's samples
[[nodiscard]] Bitree complete_bitree(const VertexMask& selected, std::span<const double> heights);

/// The number of triangles of the hierarchy, before T-junctions are closed.
/// cost  as mesh_of
[[nodiscard]] std::size_t leaf_triangles(const Bitree& bitree);

/// The surface as a mesh without T-junctions. A triangle with vertices of finer triangles on its sides is cut from its
/// corner to each of them: one triangle more for each, no more vertices, the same surface. With voids, a piece of a
/// triangle that holds data may hold none.
///
/// returns  triangles along a Sierpinski curve, counter-clockwise; most share a side with the next
/// cost     linear in triangles and vertices
[[nodiscard]] Mesh mesh_of(const Bitree& bitree);

/// Indices for GL_TRIANGLE_STRIP: the triangles of a mesh in their order, with the same winding. A triangle that shares
/// a side with the one before needs one index, two after a repeated turn. Otherwise degenerate triangles (two equal
/// indices; do not draw them) lead to it.
///
/// mesh    all triangles wound alike, as in every mesh of Talus
/// cost    linear
/// source  [A §4] uses a grammar over the hierarchy; here any mesh, so cut triangles are included
[[nodiscard]] Array<std::uint32_t> alternating_indices(const Mesh& mesh);

}  // namespace talus
