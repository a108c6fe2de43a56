#include "engine/saturation.hpp"

#include <algorithm>

namespace talus {
namespace {

/// Where arithmetic rounds, a margin has lifted every error off zero. If nothing below the vertex has an
/// error and the vertex itself is exactly the mean of its hypotenuse, then by induction all samples of
/// the diamond are interpolated exactly.
bool is_exactly_zero(const ErrorInput& input, GridPoint p) {
  const HeightField& field = input.field;
  const Diamond d = diamond(p);
  if (!field.extent.contains(p) || !field.extent.contains(d.ends[0]) || !field.extent.contains(d.ends[1])) return false;
  if (input.voids != nullptr && (input.voids->half(p, 0) == kMixed || input.voids->half(p, 1) == kMixed)) return false;
  return halves_exactly(field[d.ends[0]], field[d.ends[1]], field[p]);
}

/// Side midpoints gather from the centres one level finer, centres from the side midpoints around them.
class Saturation {
 public:
  Saturation(const ErrorInput& input, LevelGrid<ErrorCode>& errors) : input_(input), errors_(errors) {}

  void run() {
    for (int shift = 0; shift < errors_.levels(); ++shift) {
      const Units level = errors_.units(shift);
      const Units finer = shift == 0 ? Units{} : errors_.units(shift - 1);
      if (shift > 0) gather(shift, level, finer, false);  // finest side midpoints are the finest of all
      gather(shift, level, level, true);
    }
  }

 private:
  using Units = LevelGrid<ErrorCode>::Units;

  void gather(int shift, const Units& level, const Units& from, bool centres) {
    for (std::int32_t row = level.first_row; row <= level.last_row; ++row) {
      const bool row_odd = (row & 1) != 0;
      if (centres && !row_odd) continue;
      const std::int32_t wanted = centres || !row_odd ? 1 : 0;  // parity of the column
      for (std::int32_t col = level.first_col + ((level.first_col ^ wanted) & 1); col <= level.last_col; col += 2) {
        ErrorCode& own = level.at(col, row);
        const ErrorCode below = centres ? around(from, col, row) : corners(from, 2 * col, 2 * row);
        if (input_.bits != nullptr && own != 0 && below == 0 &&
            is_exactly_zero(input_, {col * (1 << shift), row * (1 << shift)})) {
          own = 0;
        }
        own = std::max(own, below);
      }
    }
  }

  /// Beyond the rim every error is zero.
  static ErrorCode at(const Units& u, std::int32_t col, std::int32_t row) {
    return u.holds(col, row) ? u.at(col, row) : ErrorCode{0};
  }
  static ErrorCode around(const Units& u, std::int32_t col, std::int32_t row) {
    if (u.holds(col - 1, row - 1) && u.holds(col + 1, row + 1)) {
      return std::max(std::max(u.at(col - 1, row), u.at(col + 1, row)),
                      std::max(u.at(col, row - 1), u.at(col, row + 1)));
    }
    return std::max(std::max(at(u, col - 1, row), at(u, col + 1, row)),
                    std::max(at(u, col, row - 1), at(u, col, row + 1)));
  }
  static ErrorCode corners(const Units& u, std::int32_t col, std::int32_t row) {
    if (u.holds(col - 1, row - 1) && u.holds(col + 1, row + 1)) {
      return std::max(std::max(u.at(col - 1, row - 1), u.at(col + 1, row - 1)),
                      std::max(u.at(col - 1, row + 1), u.at(col + 1, row + 1)));
    }
    return std::max(std::max(at(u, col - 1, row - 1), at(u, col + 1, row - 1)),
                    std::max(at(u, col - 1, row + 1), at(u, col + 1, row + 1)));
  }

  const ErrorInput& input_;
  LevelGrid<ErrorCode>& errors_;
};

}  // namespace

void saturate(const ErrorInput& input, LevelGrid<ErrorCode>& errors) { Saturation(input, errors).run(); }

}  // namespace talus
