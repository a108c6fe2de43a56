#include "engine/vertex_error.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

double reference_half_error(const ErrorInput& input, GridPoint vertex, int side) {
  const HeightField& field = input.field;
  const HalfDiamond t = half_diamond(vertex, side);
  if (!inside(t, field.extent)) return 0;
  const Holds holds = input.voids == nullptr ? kData : input.voids->half(vertex, side);
  if ((holds & kData) == 0) return 0;
  const Plane<double> plane = plane_of(t, [&](GridPoint p) { return field[p]; });
  double largest = 0;
  for (std::int32_t row = t.top(); row <= t.bottom(); ++row) {
    const double start = plane.on_row(row);
    const auto [lo, hi] = t.columns(row);
    for (std::int32_t col = lo; col <= hi; ++col) {
      const std::size_t i = field.index({col, row});
      if (!field.valid.empty() && !field.valid[i]) continue;
      largest = std::max(largest, std::abs(field.heights[i] - (start + plane.right * (col - plane.col))));
    }
  }
  double metres = field.distance.metres(largest);
  if (!field.exact) metres += kRoundingMargin;
  return holds == kMixed ? std::max(metres, detail::mixed_error(input, t)) : metres;
}

bool halves_exactly(double a, double b, double m) {
  const double sum = a + b, back = sum - a;
  const double lost = (a - (sum - back)) + (b - back);
  return sum == 2 * m && lost == 0;
}

double finest_error(double height, double end, double other_end, const CodeDistance& distance, bool exact) {
  const double metres = distance.metres(std::abs(height - (end + other_end) / 2));
  if (exact) return metres;
  return halves_exactly(end, other_end, height) ? 0 : metres + kRoundingMargin;
}

namespace {

template <class Errors>
LevelGrid<ErrorCode> all_errors(const ErrorInput& input, Errors&& fill) {
  LevelGrid<ErrorCode> errors(input.field.extent, 0);
  fill(errors);
  return errors;
}

}  // namespace

LevelGrid<ErrorCode> reference_errors(const ErrorInput& input) {
  return all_errors(input, [&](LevelGrid<ErrorCode>& errors) {
    for (int shift = 0; shift < errors.levels(); ++shift) {
      for (const bool centres : {false, true}) {
        errors.for_each(shift, centres, [&](GridPoint p) {
          errors[p] = error_code(std::max(reference_half_error(input, p, 0), reference_half_error(input, p, 1)));
        });
      }
    }
  });
}

LevelGrid<ErrorCode> vertex_errors(const ErrorInput& input) {
  return all_errors(input, [&](LevelGrid<ErrorCode>& errors) {
    detail::block_errors(input, errors);
    detail::slab_errors(input, errors);
  });
}

namespace detail {

double mixed_error(const ErrorInput& input, const HalfDiamond& t) { return input.void_weight * input.ground_side(t); }

}  // namespace detail
}  // namespace talus
