#include "engine/error/other_errors.hpp"

#include <algorithm>
#include <span>
#include <type_traits>
#include <variant>

#include "engine/error/block_errors.hpp"
#include "engine/error/saturation.hpp"

namespace talus::detail {
namespace {

using Units = LevelGrid<ErrorCode>::Units;

/// Distances of vertices from the middle of the ends of their side, row by row.
template <class Code>
class MiddleErrors {
 public:
  MiddleErrors(const ErrorInput& input, LevelGrid<ErrorCode>& errors)
      : input_(input),
        field_(input.field),
        heights_(std::get<std::span<const Code>>(field_.heights)),
        errors_(errors) {}

  void run() {
    const GridRect& e = field_.extent;
    for (int shift = 0; shift < errors_.levels(); ++shift) {
      const Units level = errors_.units(shift);
      const std::int32_t s = 1 << shift;
      // Vertices whose neighbours lie in the extent, in columns or in rows.
      const GridPoint first{(e.first.col + s - 1) >> shift, (e.first.row + s - 1) >> shift};
      const GridPoint last{e.last.col >> shift, e.last.row >> shift};
      for (std::int32_t row = first.row; row <= last.row; ++row) {
        if ((row & 1) == 0) {
          if (row == first.row && row == last.row) continue;  // no triangle on either side
          side_midpoints(level, shift, row, (first.col + 1) | 1, last.col - 1, 1);
        } else if (row > first.row && row < last.row) {
          if (first.col == last.col) continue;
          side_midpoints(level, shift, row, (first.col + 1) & ~1, last.col, field_.extent.cols());
          centres(level, shift, row, (first.col + 1) | 1, last.col - 1);
        }
      }
    }
  }

 private:
  /// Every second of a row; `step`: from one sample to the next on the side.
  void side_midpoints(const Units& level, int shift, std::int32_t row, std::int32_t first, std::int32_t last,
                      std::int64_t step) {
    const std::ptrdiff_t to_end = step << shift;
    for (std::int32_t col = first; col <= last; col += 2) settle(level, shift, col, row, to_end);
  }
  void centres(const Units& level, int shift, std::int32_t row, std::int32_t first, std::int32_t last) {
    const std::ptrdiff_t cols = field_.extent.cols();
    for (std::int32_t col = first; col <= last; col += 2) {
      const bool falls = (((col - 1) ^ (row - 1)) & 2) == 0;  // the diagonal, from north-west to south-east
      settle(level, shift, col, row, (falls ? cols + 1 : cols - 1) * (std::ptrdiff_t{1} << shift));
    }
  }
  void settle(const Units& level, int shift, std::int32_t col, std::int32_t row, std::ptrdiff_t to_end) {
    if (input_.voids != nullptr && (input_.voids->units(shift).at(col, row) & (kData | kData << 2)) == 0) return;
    const GridPoint p{col * (1 << shift), row * (1 << shift)};
    const Code* own = &heights_[field_.index(p)];
    const double metres = finest_error(static_cast<double>(*own), static_cast<double>(own[-to_end]),
                                       static_cast<double>(own[to_end]), field_.distance);
    level.at(col, row) = std::max(level.at(col, row), error_code(metres));
  }

  const ErrorInput& input_;
  const HeightField& field_;
  std::span<const Code> heights_;
  LevelGrid<ErrorCode>& errors_;
};

/// As saturate(), by the rule's own sum.
void gather(const ErrorRule& rule, LevelGrid<ErrorCode>& errors) {
  for (int shift = 0; shift < errors.levels(); ++shift) {
    for (const bool centres : {false, true}) {
      if (shift == 0 && !centres) continue;  // the finest of all
      errors.for_each(shift, centres, [&](GridPoint p) {
        ErrorCode below = 0;
        const Children all = children(p);
        for (int i = 0; i < all.count; ++i) {
          const GridPoint child = all.at[static_cast<std::size_t>(i)];
          if (errors.holds(child)) below = std::max(below, errors[child]);
        }
        errors[p] = rule.over(errors[p], below);
      });
    }
  }
}

}  // namespace

void other_errors(const ErrorInput& input, LevelGrid<ErrorCode>& errors) {
  if (input.rule.measures_samples() || input.rule.metric == ErrorMetric::perpendicular) {
    const LevelGrid<ErrorCode> own = reference_errors(input, errors.levels());
    for (int shift = 0; shift < errors.levels(); ++shift) {
      for (const bool centres : {false, true})
        errors.for_each(shift, centres, [&](GridPoint p) { errors[p] = std::max(errors[p], own[p]); });
    }
  } else {
    std::visit(
        [&](auto heights) {
          using Code = std::remove_const_t<typename decltype(heights)::element_type>;
          MiddleErrors<Code>(input, errors).run();
        },
        input.field.heights);
    if (input.voids != nullptr) mixed_errors(input, errors);
  }
  if (input.rule.kind == ErrorKind::nested) {
    gather(input.rule, errors);
  } else {
    saturate(input, errors);
  }
}

}  // namespace talus::detail
