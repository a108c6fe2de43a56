#pragma once
// Implied errors: they are not stored, because they follow from the heights of the page.
//
// The saturated error ê of a vertex of spacing s = 1, 2 or 4 depends on samples within this many columns and rows:
//   reach(side midpoint s) = max(s, s/2 + reach(centre s/2)),   reach(centre s) = s + reach(side midpoint s)
// This is 1 for both of spacing 1, then 2, 4, 6, 10. The reason: half-diamonds of a vertex lie within s of it; children
// of a side midpoint are centres at (±s/2, ±s/2), those of a centre are side midpoints at (±s, 0) and (0, ±s). A side
// midpoint of spacing 1 depends only on the ends of its side, but one of its apexes must be valid. If all these samples
// are valid and in the page, ê is *implied*: it is computed when the page is read.
//
// The children of an implied vertex are implied, so no stored code, which is rounded up, is below an implied parent. A
// stored parent's code is at least the error of an implied child. So a threshold selects a set with all its parents.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/page/page_layout.hpp"

namespace talus {

inline constexpr int kImpliedLevels = kBandLevels;

/// Computes the implied errors of a page's square. Distance is one of these:
/// int32_t  eighths of a height code, for whole numbers that differ by less than 2^25
/// double   height codes, for heights whose interpolation is exact
template <class Distance>
class ImpliedErrors {
 public:
  ImpliedErrors();
  /// valid      1: the sample is valid; empty: all are valid
  /// distances  error of the vertex at square[i]; -1: not implied
  /// cost       about 0.7 ns a sample for whole numbers: a vector holds sixteen blocks of 8² samples
  void compute(std::span<const Distance> square, const PresentRect& present, std::span<const std::uint8_t> valid,
               std::span<Distance> distances);

 private:
  struct Lanes;
  std::shared_ptr<Lanes> lanes_;
};

extern template class ImpliedErrors<std::int32_t>;
extern template class ImpliedErrors<double>;

/// Computes the implied errors of spacing 1 for any doubles. Distances that arithmetic would round are rounded up.
void implied_errors_rounded_up(std::span<const double> square, const PresentRect& present,
                               std::span<const std::uint8_t> valid, std::span<double> distances);

/// Whether the vertex of spacing 1, 2 or 4 at (col, row) has an implied error, if the page has no voids.
[[nodiscard]] bool is_implied_by_place(std::int32_t col, std::int32_t row, const PresentRect& present);

}  // namespace talus
