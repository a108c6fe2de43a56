#pragma once
// The error of a vertex: the largest distance of the samples in its diamond from the surface without the vertex. [P98
// §5, Eq. 1]

#include <functional>

#include "engine/error/block_bits.hpp"
#include "engine/error/error_ladder.hpp"
#include "engine/error/error_rule.hpp"
#include "engine/error/height_field.hpp"
#include "engine/error/level_grid.hpp"
#include "engine/error/voids.hpp"
#include "engine/quadtree/half_diamond.hpp"

namespace talus {

/// Longest side of a triangle on the ground in metres: where it mixes data and voids, the outline of data may be off by
/// this. It depends on the triangle's rows and shape, not on its columns.
using GroundSide = std::function<double(const HalfDiamond&)>;

/// What errors are computed from. `voids` null: all samples are valid. `bits` null: all codes are whole numbers of 16
/// bits, so nothing rounds.
struct ErrorInput {
  HeightField field;
  VoidMap* voids = nullptr;
  const BlockBits* bits = nullptr;
  GroundSide ground_side;  ///< needed with voids only
  double void_weight = 1;  ///< metres of error a metre of ground side
  ErrorRule rule = {};

  /// Metres to add to a computed error of a half-diamond, see BlockBits.
  [[nodiscard]] double margin(GridPoint vertex, int side) const {
    return bits == nullptr || bits->is_exact(vertex, side) ? 0 : kRoundingMargin;
  }
};

/// The error of one half in metres by a plain loop over the closed triangle; kernels are tested against it. 0: the half
/// leaves the extent or holds no data. A half with data and voids has at least its weighted ground side. `holds` is
/// needed for levels above those of the input's voids.
[[nodiscard]] double reference_half_error(const ErrorInput& input, GridPoint vertex, int side, Holds holds);
[[nodiscard]] double reference_half_error(const ErrorInput& input, GridPoint vertex, int side);

/// The largest distance, in codes, of the valid samples of a closed triangle from a plane.
[[nodiscard]] double largest_distance(const HeightField& field, const HalfDiamond& t, const Plane<double>& plane);

/// Whether (a+b)/2 == m in exact arithmetic, by the error-free sum of two doubles.
[[nodiscard]] bool halves_exactly(double a, double b, double m);

/// Error of a finest side midpoint in metres, from its height and those of the ends of its side: its diamond has no
/// other sample. It has the rounding margin only if this computation rounded.
[[nodiscard]] double finest_error(double height, double end, double other_end, const CodeDistance& distance);

/// Error codes of all vertices of the finest levels before saturation, by the plain loop. Slow.
[[nodiscard]] LevelGrid<ErrorCode> reference_errors(const ErrorInput& input, int levels);

namespace detail {

[[nodiscard]] double mixed_error(const ErrorInput& input, const HalfDiamond& t);

}  // namespace detail

}  // namespace talus
