#pragma once
// The other way to close a mesh: triangles of which each is split for itself, and vertices made up where one meets
// finer ones. It stands beside the restricted quadtree to be compared with it: docs/formats-compared.md.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "talus/array.hpp"
#include "talus/description.hpp"
#include "talus/quadtree.hpp"
#include "talus/units.hpp"

namespace talus {

/// A hierarchy of right triangles without the restriction that the two of a diamond are split together.
///
/// Of its vertices some are *selected*: they have the source's height and split both triangles of their diamond. The
/// others are *fictitious*: a triangle inside one of the halves needed it split. Their height is halfway between the
/// ends of their diamond, so that they lie on the other half's side if that stays whole, and they follow from the
/// selected ones: nobody has to send them.
struct Bitree {
  /// What a vertex is, bit by bit.
  static constexpr std::uint8_t kSplitsFirst = 1;   ///< the half of apexes[0] (engine/quadtree/grid.hpp, `Diamond`)
  static constexpr std::uint8_t kSplitsSecond = 2;  ///< the half of apexes[1]
  static constexpr std::uint8_t kSelected = 4;

  GridRect region{{0, 0}, {-1, -1}};
  VertexMask vertices;               ///< over the region, sealed
  std::vector<std::uint8_t> kinds;   ///< by rank
  Array<double> heights;             ///< by rank, in the source's vertical unit
  std::vector<std::uint8_t> covers;  ///< by rank, as RestrictedQuadtree::covers; empty: all triangles hold data
  Metres tolerance;                  ///< as asked
  /// No covered sample is farther from the surface: the tolerance plus, where heights are no binary fractions, a few
  /// nanometres of rounding. Infinite if it was not verified.
  Metres bound;
  std::size_t selected = 0;   ///< vertices with a source's height; the other ones are fictitious
  std::size_t corrected = 0;  ///< of those, selected because the surface with fictitious vertices left a sample out

  [[nodiscard]] std::size_t fictitious() const { return vertices.size() - selected; }
};

struct BitreeOptions {
  double metres_per_unit = 1;  ///< of heights
  /// Longer side of a cell on the ground, and metres of error for a metre of ground: a triangle that mixes data and
  /// void is split while its longest side, counted so, is above the tolerance. Without voids of no effect.
  Metres cell{1};
  double void_weight = 1;
  /// As published: what fictitious vertices do to the surface is not looked at, and the bound is lost.
  bool verified = true;
};

/// The bitree of a rectangle of samples: selected is every vertex whose error is above the tolerance, as in the
/// restricted quadtree before its closure; what the region's sides need, as there; and, so that the bound holds, any
/// vertex whose made-up height leaves a covered sample farther off than the tolerance.
///
/// Voids are treated as in Snapshot::ask: a triangle is there iff it holds a valid finest one, and void vertices that
/// are selected get the height of a sample nearby. Bitrees of regions that share a side need not meet there.
///
/// samples    values and valid of the region's size, row by row
/// tolerance  metres, >= 0, infinity allowed
/// fails      invalid_argument: other sizes than the region's, a tolerance below 0 or none, a valid height that is not
///            finite, options that are not positive
/// cost       time in samples times levels for the errors, then in triangles and the samples below those with
/// fictitious
///            corners for each round of verification; memory: 9 bytes a sample, 19 with voids
/// source     [A §2.2, §3.2]; verification: ours
[[nodiscard]] Bitree bitree_of(const SampleWindow& samples, Metres tolerance, const BitreeOptions& options = {});

/// The bitree that follows from selected vertices: the fictitious ones that they need, and all heights.
///
/// selected  over the region, with what its sides need (engine/quadtree/border.hpp), sealed
/// heights   by rank
/// returns   without covers; its bound is infinite, for nothing is known of the samples
/// fails     invalid_argument: another number of heights; border vertices that are missing
/// cost      linear in the region's samples
[[nodiscard]] Bitree complete_bitree(const VertexMask& selected, std::span<const double> heights);

/// How many triangles its hierarchy has, T-junctions and all.
/// cost  as mesh_of
[[nodiscard]] std::size_t leaf_triangles(const Bitree& bitree);

/// Its surface, as a conforming mesh. A triangle whose sides have vertices of finer ones on them is cut at these, from
/// the corner across: no vertex is added and the surface stays where it is. One triangle more for each vertex on a
/// side. With voids a part of a triangle that mixes may hold no data of its own.
///
/// returns  triangles in the order of a Sierpinski curve, most sharing a side with the next; counter-clockwise
/// cost     linear in triangles and vertices
[[nodiscard]] Mesh mesh_of(const Bitree& bitree);

/// A mesh as one list of indices for GL_TRIANGLE_STRIP: its triangles in their order, each turned as it is. Where two
/// that follow each other share a side, the second takes one index, or two after a turn that repeats; otherwise an
/// invisible line leads from one to the other. Triangles with two equal indices are such lines: not to be drawn.
///
/// mesh    neighbours turned alike, as all meshes here are
/// cost    linear
/// source  [A §4]: there by a grammar over the hierarchy, here over any mesh, so that cut triangles are in it
[[nodiscard]] Array<std::uint32_t> alternating_indices(const Mesh& mesh);

}  // namespace talus
