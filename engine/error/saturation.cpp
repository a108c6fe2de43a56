#include "engine/error/saturation.hpp"

#include <algorithm>

#include "engine/error/kernel_choice.hpp"

namespace talus {
namespace {

/// Whether a vertex's error is exactly 0, where a rounding margin lifted all errors above it. If no descendant has an
/// error and the vertex is exactly the mean of its hypotenuse, then by induction all samples of the diamond are
/// interpolated exactly.
bool is_exactly_zero(const ErrorInput& input, GridPoint p) {
  const HeightField& field = input.field;
  const Diamond d = diamond(p);
  if (!field.extent.contains(p) || !field.extent.contains(d.ends[0]) || !field.extent.contains(d.ends[1])) return false;
  if (input.voids != nullptr && (input.voids->half(p, 0) == kMixed || input.voids->half(p, 1) == kMixed)) return false;
  return halves_exactly(field[d.ends[0]], field[d.ends[1]], field[p]);
}

/// The children of a side midpoint are centres one level finer; those of a centre are the side midpoints around it.
class Saturation {
 public:
  Saturation(const ErrorInput& input, LevelGrid<ErrorCode>& errors) : input_(input), errors_(errors) {}

  void run() {
    if (input_.bits == nullptr || input_.bits->all_exact()) return run_exact();
    for (int shift = 0; shift < errors_.levels(); ++shift) {
      const Units level = errors_.units(shift);
      const Units finer = shift == 0 ? Units{} : errors_.units(shift - 1);
      if (shift > 0) gather(shift, level, finer, false);  // finest side midpoints have no children
      gather(shift, level, level, true);
    }
  }

 private:
  using Units = LevelGrid<ErrorCode>::Units;

  /// Without rounding: maxima of whole rows; single vertices at the rim, where neighbours may be missing.
  void run_exact() {
    for (int shift = 0; shift < errors_.levels(); ++shift) {
      const Units level = errors_.units(shift);
      if (shift > 0) {
        const Units finer = errors_.units(shift - 1);
        for (std::int32_t row = level.first_row; row <= level.last_row; ++row) raise_sides(level, finer, row);
      }
      for (std::int32_t row = level.first_row | 1; row <= level.last_row; row += 2) raise_centres(level, row);
    }
  }

  void raise_sides(const Units& level, const Units& finer, std::int32_t row) const {
    const int parity = (row & 1) != 0 ? 0 : 1;  // parity of the columns with side midpoints
    const std::int32_t begin = level.first_col + ((level.first_col ^ parity) & 1);
    // Columns with all four corners.
    std::int32_t first = std::max(begin, (finer.first_col + 2) >> 1),
                 last = std::min(level.last_col, (finer.last_col - 1) >> 1);
    first += (first ^ parity) & 1;
    if (2 * row - 1 < finer.first_row || 2 * row + 1 > finer.last_row) last = first - 1;
    if (first <= last) {
      kernel_.raise_by_corners(&level.at(first, row), &finer.at(2 * first, 2 * row - 1),
                               &finer.at(2 * first, 2 * row + 1), last - first + 1);
    }
    for (std::int32_t col = begin; col <= level.last_col; col += 2) {
      if (col == first && first <= last) col = last + 1 + ((last + 1 - first) & 1);
      if (col > level.last_col) break;
      level.at(col, row) = std::max(level.at(col, row), corners(finer, 2 * col, 2 * row));
    }
  }

  void raise_centres(const Units& level, std::int32_t row) const {
    const std::int32_t first = (level.first_col + 1) & ~1;  // just before the first with all neighbours
    if (row == level.first_row || row == level.last_row || first + 2 > level.last_col) {
      for (std::int32_t col = level.first_col | 1; col <= level.last_col; col += 2) raise_centre(level, col, row);
      return;
    }
    ErrorCode* from = &level.at(first, row);
    kernel_.raise_by_neighbours(from, from - level.stride, from + level.stride, level.last_col - first + 1);
    for (const std::int32_t col : {level.first_col, level.last_col}) {
      if ((col & 1) != 0) raise_centre(level, col, row);
    }
  }
  static void raise_centre(const Units& level, std::int32_t col, std::int32_t row) {
    level.at(col, row) = std::max(level.at(col, row), around(level, col, row));
  }

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

  /// Outside the rim every error is zero.
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
  const detail::BlockKernel& kernel_ = detail::block_kernel();
};

}  // namespace

void saturate(const ErrorInput& input, LevelGrid<ErrorCode>& errors) { Saturation(input, errors).run(); }

}  // namespace talus
