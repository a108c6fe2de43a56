#pragma once
// The heights of a page as whole numbers, coarse to fine: each predicted from those before it.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

#include "engine/page/number_coder.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {

inline constexpr std::size_t kSquare = static_cast<std::size_t>(kPageSide) * kPageSide;

/// Samples of a page's square that are there: columns first_col to end_col - 1, rows alike.
struct PresentRect {
  std::int32_t first_col = 0, end_col = kPageSide, first_row = 0, end_row = kPageSide;
  friend bool operator==(const PresentRect&, const PresentRect&) = default;
};

/// Contexts of heights; other parts of a page take those behind.
inline constexpr int kHeightContexts = 48;

/// Puts the numbers of a page's square, and takes them back into the same memory each time.
///
/// The square is always whole: numbers where `coded` is 0 (void, or outside the extent) are not stored but become
/// what is predicted for them, so prediction needs no case for sides and holes. Of those outside the extent only the
/// few are predicted that a number in it depends on. Only differences count, so the caller subtracts a base first.
/// Number is int32_t or int64_t; arithmetic wraps around, whatever the numbers are.
///
/// prediction  each level of spacing s has its centres predicted from the grid of spacing 2s around them, then its
///             side midpoints from both, which is the same grid turned by 45 degrees: the four neighbours weigh
///             22/64 each, the eight behind them -3/64 each
/// context     how much those eight bend: the sum of |second differences|, two classes an octave
/// cost        about 2 ns a sample; of a page cut by the extent, also of some rows and columns around it
template <class Number>
class HeightLevels {
 public:
  HeightLevels();
  /// `coded` empty: all are, and all are present; else 0 outside of `present`. Where a number there was not coded
  /// `square` holds its prediction; outside it is left with anything.
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
