#pragma once
// The heights of a page as whole numbers, coarse to fine: each is predicted from earlier ones.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

#include "engine/page/number_coder.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {

inline constexpr std::size_t kSquare = static_cast<std::size_t>(kPageSide) * kPageSide;

/// The samples of a page's square that exist: columns first_col to end_col - 1, rows alike.
struct PresentRect {
  std::int32_t first_col = 0, end_col = kPageSide, first_row = 0, end_row = kPageSide;
  friend bool operator==(const PresentRect&, const PresentRect&) = default;
};

/// Contexts of heights; the other parts of a page use later ones.
inline constexpr int kHeightContexts = 48;

/// Writes and reads the numbers of a page's square, reusing its memory.
///
/// The square is always whole: a number with `coded` 0 (void, or outside the extent) is not stored and becomes its
/// prediction, so sides and holes are no special cases. Outside the extent, only numbers that others depend on are
/// computed. Only differences count, so subtract a base first. Number is int32_t or int64_t; arithmetic wraps around.
///
/// prediction  centres of spacing s from the grid of spacing 2s around them; then side midpoints from both, which is
///             the same grid turned by 45 degrees. The four neighbours weigh 22/64 each, the eight behind them -3/64
///             each
/// context     the sum of the |second differences| of those eight, two classes an octave
/// cost        about 2 ns a sample; for a page cut by the extent, also some rows and columns around it
template <class Number>
class HeightLevels {
 public:
  HeightLevels();
  /// `coded` empty: all samples are present and coded; else 0 outside `present`. Afterwards a number in `present` that
  /// is not coded holds its prediction; those outside are unspecified.
  void put(std::span<Number> square, std::span<const std::uint8_t> coded, const PresentRect& present,
           NumberWriter& out);
  void get(std::span<Number> square, std::span<const std::uint8_t> coded, const PresentRect& present, NumberReader& in);

 private:
  using W = std::make_unsigned_t<Number>;  // wraps around
  template <class Settle>
  void run(std::span<Number> square, const PresentRect& present, Settle&& settle);

  struct Grids;
  std::shared_ptr<Grids> grids_;
};

extern template class HeightLevels<std::int32_t>;
extern template class HeightLevels<std::int64_t>;

}  // namespace talus
