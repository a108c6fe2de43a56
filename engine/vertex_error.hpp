#pragma once
// The error of a vertex: how far the samples of its diamond lie from the two triangles that stand there
// while it is absent. [P98 §5, Eq. 1]

#include <functional>

#include "engine/error_ladder.hpp"
#include "engine/half_diamond.hpp"
#include "engine/height_field.hpp"
#include "engine/level_grid.hpp"
#include "engine/voids.hpp"

namespace talus {

/// Longest ground side of a triangle in metres: what the outline of data may be off where one that mixes
/// data and void stands for it.
using GroundSide = std::function<double(const HalfDiamond&)>;

/// What the errors are computed from. `voids` is null where every sample is data.
struct ErrorInput {
  HeightField field;
  const VoidMap* voids = nullptr;
  GroundSide ground_side;  ///< used with voids only
  double void_weight = 1;  ///< metres of error per metre of ground side
};

/// Vertical error of one half in metres, by a plain loop over the closed triangle: 0 if it leaves the
/// extent or holds no data; at least the weighted ground side if it mixes data and void. The reference
/// the kernels are held to.
[[nodiscard]] double reference_half_error(const ErrorInput& input, GridPoint vertex, int side);

/// (a+b)/2 == m in exact arithmetic: by the error-free sum of two doubles.
[[nodiscard]] bool halves_exactly(double a, double b, double m);

/// Error of a finest side midpoint in metres, from its own height and the two ends of its side: such a
/// vertex has no samples but itself to miss.
[[nodiscard]] double finest_error(double height, double end, double other_end, const CodeDistance& distance,
                                  bool exact);

/// Error codes of all vertices, not yet saturated, by the plain loop. Slow: n² log n.
[[nodiscard]] LevelGrid<ErrorCode> reference_errors(const ErrorInput& input);

/// The same up to saturation, fast: where all of a block is data, eight blocks side by side in the lanes of
/// a vector and only the interior and the hypotenuse of each triangle (its legs are its children's
/// hypotenuses, so saturation brings them back); above the blocks, fitted planes with a radius tell
/// which samples can matter. About linear.
[[nodiscard]] LevelGrid<ErrorCode> vertex_errors(const ErrorInput& input);

/// Cells along a block's side: the unit the fast kernel works in. Vertices of smaller spacing are settled
/// inside blocks, the others, and the blocks' own centres, by slabs.
inline constexpr int kBlockShift = 6;
inline constexpr std::int32_t kBlockSide = 1 << kBlockShift;

namespace detail {

[[nodiscard]] constexpr bool is_settled_in_block(GridPoint p) {
  return spacing(p) < kBlockSide && !(is_centre(p) && 2 * spacing(p) == kBlockSide);
}

/// A distance in height codes as a stored error.
[[nodiscard]] inline ErrorCode code_of(const HeightField& field, double distance) {
  return error_code(field.distance.metres(distance) + (field.exact ? 0 : kRoundingMargin));
}
[[nodiscard]] double mixed_error(const ErrorInput& input, const HalfDiamond& t);

/// Levels below a block's side (engine/block_errors.cpp) and those above (engine/slab_errors.cpp).
void block_errors(const ErrorInput& input, LevelGrid<ErrorCode>& errors);
void slab_errors(const ErrorInput& input, LevelGrid<ErrorCode>& errors);

}  // namespace detail

}  // namespace talus
