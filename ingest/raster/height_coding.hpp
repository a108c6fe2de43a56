#pragma once
// Turns raw samples into height codes.

#include <cstddef>
#include <cstdint>

#include "ingest/raster/raster_facts.hpp"

namespace talus {

struct RasterCoding {
  enum class Rule {
    raw,     ///< a code is the sample
    value,   ///< a code is the height, with scale and offset applied
    rounded  ///< a code is the height in steps, rounded to the nearest
  };
  Rule rule = Rule::raw;
  HeightStep step;
};

/// A rectangle of samples in a larger one.
template <class T>
struct Patch {
  T* samples;
  std::size_t cols, rows, stride;
  [[nodiscard]] T* row(std::size_t r) const { return samples + r * stride; }
};

/// Raw samples in this range are certainly heights, and equal to their codes. code_heights checks the others.
template <class T>
struct SureHeights {
  T low, high;
};
template <class T>
[[nodiscard]] SureHeights<T> sure_heights(const RasterFacts& facts, const RasterCoding& coding);

/// Turns the valid raw samples into codes.
///
/// T      int16_t, float or double: holds every raw sample and every code
/// first  column and row of the first sample in the raster, for failures
/// fails  invalid_argument: a sample that is no height
template <class T>
void code_heights(const Patch<T>& patch, const Patch<std::uint8_t>& valid, const RasterFacts& facts,
                  const RasterCoding& coding, GridPoint first);

}  // namespace talus
