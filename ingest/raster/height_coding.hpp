#pragma once
// Raw samples become height codes.

#include <cstddef>
#include <cstdint>

#include "ingest/raster/raster_facts.hpp"

namespace talus {

struct RasterCoding {
  enum class Rule {
    raw,     ///< a code is the sample
    value,   ///< a code is the height: scale and offset applied
    rounded  ///< a code is the height in whole steps, the nearest
  };
  Rule rule = Rule::raw;
  HeightStep step;
};

/// A rectangle of samples somewhere in a larger one.
template <class T>
struct Patch {
  T* samples;
  std::size_t cols, rows, stride;
  [[nodiscard]] T* row(std::size_t r) const { return samples + r * stride; }
};

/// Raw samples that are their own codes and heights for certain; beyond them code_heights looks closely.
template <class T>
struct SureHeights {
  T low, high;
};
template <class T>
[[nodiscard]] SureHeights<T> sure_heights(const RasterFacts& facts, const RasterCoding& coding);

/// Makes codes of the raw samples that are data.
///
/// T      int16_t, float or double, one that holds every raw sample and every code
/// first  the raster's column and row of the first sample, for failures
/// fails  invalid_argument: a sample that is no height
template <class T>
void code_heights(const Patch<T>& patch, const Patch<std::uint8_t>& valid, const RasterFacts& facts,
                  const RasterCoding& coding, GridPoint first);

}  // namespace talus
