#include "engine/error/vertex_error.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

double largest_distance(const HeightField& field, const HalfDiamond& t, const Plane<double>& plane) {
  return std::visit(
      [&](auto heights) {
        double largest = 0;
        for (std::int32_t row = t.top(); row <= t.bottom(); ++row) {
          const double start = plane.on_row(row);
          const auto [lo, hi] = t.columns(row);
          std::size_t i = field.index({lo, row});
          for (std::int32_t col = lo; col <= hi; ++col, ++i) {
            if (!field.is_valid(i)) continue;
            const double on_plane = start + plane.right * (col - plane.col);
            largest = std::max(largest, std::abs(static_cast<double>(heights[i]) - on_plane));
          }
        }
        return largest;
      },
      field.heights);
}

double reference_half_error(const ErrorInput& input, GridPoint vertex, int side, Holds holds) {
  const HeightField& field = input.field;
  const HalfDiamond t = half_diamond(vertex, side);
  if (!inside(t, field.extent) || (holds & kData) == 0) return 0;
  const Plane<double> plane = plane_of(t, [&](GridPoint p) { return field[p]; });
  double metres = 0;
  if (t.s == 1 && !t.centre) {
    if (field.is_valid(field.index(vertex)))
      metres = finest_error(field[vertex], field[t.a], field[t.b], field.distance);
  } else {
    metres = field.distance.metres(largest_distance(field, t, plane)) + input.margin(vertex, side);
  }
  metres *= input.rule.share(t, plane, field.distance);
  return holds == kMixed ? std::max(metres, detail::mixed_error(input, t)) : metres;
}

double reference_half_error(const ErrorInput& input, GridPoint vertex, int side) {
  return reference_half_error(input, vertex, side, input.voids == nullptr ? kData : input.voids->half(vertex, side));
}

namespace {

/// The rounding error of a sum of two doubles.
double lost_in_sum(double a, double b) {
  const double sum = a + b, back = sum - a;
  return (a - (sum - back)) + (b - back);
}

}  // namespace

bool halves_exactly(double a, double b, double m) { return a + b == 2 * m && lost_in_sum(a, b) == 0; }

double finest_error(double height, double end, double other_end, const CodeDistance& distance) {
  const double sum = end + other_end, middle = sum / 2;
  const double metres = distance.metres(std::abs(height - middle));
  // Halving rounds only the smallest numbers.
  const bool rounded = lost_in_sum(end, other_end) != 0 || lost_in_sum(height, -middle) != 0 || 2 * middle != sum;
  return rounded ? metres + kRoundingMargin : metres;
}

LevelGrid<ErrorCode> reference_errors(const ErrorInput& input, int levels) {
  LevelGrid<ErrorCode> errors(input.field.extent, levels, 0);
  for (int shift = 0; shift < levels; ++shift) {
    for (const bool centres : {false, true}) {
      errors.for_each(shift, centres, [&](GridPoint p) {
        errors[p] = error_code(std::max(reference_half_error(input, p, 0), reference_half_error(input, p, 1)));
      });
    }
  }
  return errors;
}

namespace detail {

double mixed_error(const ErrorInput& input, const HalfDiamond& t) { return input.void_weight * input.ground_side(t); }

}  // namespace detail
}  // namespace talus
