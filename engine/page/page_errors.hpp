#pragma once
// Errors that need not be stored, because they follow from the heights of the page.
//
// A vertex of spacing 1, 2 or 4 with saturated error ê depends on samples no farther away, in columns or rows, than
//   reach(side midpoint s) = max(s, s/2 + reach(centre s/2)),   reach(centre s) = s + reach(side midpoint s),
// which is 1, 2, 4, 6, 10 for centres of spacing 1 and what follows. A side midpoint of spacing 1 depends on the two
// ends of its side only; one of its apexes must be data, or it misses no triangle. For the own half-diamonds of a side
// midpoint lie within s of it, those of a centre, too, and the children of a side midpoint are centres at (±s/2, ±s/2),
// those of a centre side midpoints at (±s, 0) and (0, ±s). Where all of that is in the page and data, ê is *implied*:
// computed when the page is read. With a vertex all its children are implied, so no stored code, which is rounded up,
// stands below an implied parent; and a stored parent's code is at least its implied child's error. A threshold so
// selects a set closed under parents across both kinds.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/page/page_heights.hpp"

namespace talus {

inline constexpr int kImpliedLevels = kBandLevels;

/// Implied errors over a page's square. Distance is int32_t, in eighths of a height code, for whole numbers that differ
/// by less than 2^25; or double, in height codes, where the heights' bits are such that interpolation is exact.
template <class Distance>
class ImpliedErrors {
 public:
  ImpliedErrors();
  /// distances[i] is that of the vertex at square[i], or -1 where it is not implied.
  /// `valid` 1 where a sample is data; empty: all are.
  ///
  /// cost  about 0.7 ns a sample for whole numbers: sixteen blocks of 8² side by side in a vector
  void compute(std::span<const Distance> square, const PresentRect& present, std::span<const std::uint8_t> valid,
               std::span<Distance> distances);

 private:
  struct Lanes;
  std::shared_ptr<Lanes> lanes_;
};

extern template class ImpliedErrors<std::int32_t>;
extern template class ImpliedErrors<double>;

/// The same for any doubles, spacing 1 only: where arithmetic rounds, the distance is rounded up.
void implied_errors_rounded_up(std::span<const double> square, const PresentRect& present,
                               std::span<const std::uint8_t> valid, std::span<double> distances);

/// Whether the vertex of spacing 1, 2 or 4 at (col, row) of the square has an implied error, as far as the sides of
/// the page say.
[[nodiscard]] bool is_implied_by_place(std::int32_t col, std::int32_t row, const PresentRect& present);

}  // namespace talus
