#pragma once
// The error of a vertex: how far the samples of its diamond lie from the two triangles that stand there
// while it is absent. [P98 §5, Eq. 1]

#include <functional>

#include "engine/error/block_bits.hpp"
#include "engine/error/error_ladder.hpp"
#include "engine/error/error_rule.hpp"
#include "engine/error/height_field.hpp"
#include "engine/error/level_grid.hpp"
#include "engine/error/voids.hpp"
#include "engine/quadtree/half_diamond.hpp"

namespace talus {

/// Longest ground side of a triangle in metres: what the outline of data may be off where one that mixes
/// data and void stands for it. It follows from the rows and the shape of the triangle, not from its columns.
using GroundSide = std::function<double(const HalfDiamond&)>;

/// What the errors are computed from. `voids` is null where every sample is data, `bits` where all numbers
/// are whole and within 16 bits: then nothing rounds.
struct ErrorInput {
  HeightField field;
  VoidMap* voids = nullptr;
  const BlockBits* bits = nullptr;
  GroundSide ground_side;  ///< used with voids only
  double void_weight = 1;  ///< metres of error per metre of ground side
  ErrorRule rule = {};

  /// What is added to a computed error of a half-diamond, see BlockBits.
  [[nodiscard]] double margin(GridPoint vertex, int side) const {
    return bits == nullptr || bits->is_exact(vertex, side) ? 0 : kRoundingMargin;
  }
};

/// Error of one half in metres, as the input's rule has it, by a plain loop over the closed triangle: 0 if it leaves
/// the extent or holds no data; at least the weighted ground side if it mixes data and void. The reference
/// the kernels are held to. `holds` says what the half holds where the input's voids know no such level.
[[nodiscard]] double reference_half_error(const ErrorInput& input, GridPoint vertex, int side, Holds holds);
[[nodiscard]] double reference_half_error(const ErrorInput& input, GridPoint vertex, int side);

/// Largest distance, in codes, of the valid samples of a closed triangle from a plane.
[[nodiscard]] double largest_distance(const HeightField& field, const HalfDiamond& t, const Plane<double>& plane);

/// (a+b)/2 == m in exact arithmetic: by the error-free sum of two doubles.
[[nodiscard]] bool halves_exactly(double a, double b, double m);

/// Error of a finest side midpoint in metres, from its own height and the two ends of its side: such a
/// vertex has no samples but itself to miss. It carries the rounding margin only if this very arithmetic
/// rounded.
[[nodiscard]] double finest_error(double height, double end, double other_end, const CodeDistance& distance);

/// Error codes of all vertices of the finest levels, not yet saturated, by the plain loop. Slow.
[[nodiscard]] LevelGrid<ErrorCode> reference_errors(const ErrorInput& input, int levels);

namespace detail {

[[nodiscard]] double mixed_error(const ErrorInput& input, const HalfDiamond& t);

}  // namespace detail

}  // namespace talus
