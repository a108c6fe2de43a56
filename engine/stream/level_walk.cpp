#include "engine/stream/level_walk.hpp"

#include "engine/machine/cpu.hpp"

namespace talus {
namespace {

// Thresholds are in eighths of the tolerance.
[[gnu::always_inline]] inline int energy_class(int sum) { return int{sum >= 9} + int{sum >= 16} + int{sum >= 28}; }
[[gnu::always_inline]] inline int distance_class(int size) { return int{size >= 2} + int{size >= 5} + int{size >= 9}; }

template <class Code>
[[gnu::always_inline]] inline void expect_each(const Expectations<Code>& c, float scale, int kind) {
  const int first = kind * kEnergies * kDistances;
  const std::size_t count = c.count;
  // __restrict: no arrays overlap, so the compiler can use vectors.
  const Code* __restrict end1 = c.end1, * __restrict end2 = c.end2, * __restrict beside1 = c.beside1, * __restrict beside2 = c.beside2;
  Code* __restrict predicted = c.predicted, * __restrict flips = c.flips;
  std::uint8_t* __restrict contexts = c.contexts;  // at first the distance between both predictions
  for (std::size_t i = 0; i < count; ++i) {
    const Code middle = halfway(end1[i], end2[i]);
    predicted[i] = middle;
    flips[i] = wrapped_difference(halfway(beside1[i], beside2[i]), middle);
  }
  for (std::size_t i = 0; i < count; ++i) contexts[i] = Scale::size(flips[i], scale);
  for (std::size_t i = 0; i < count; ++i) flips[i] = static_cast<Code>(flips[i] >> (8 * sizeof(Code) - 1));
  const std::uint8_t* __restrict size1 = c.size1, * __restrict size2 = c.size2;
  for (std::size_t i = 0; i < count; ++i) {
    const int sum = int{size1[i]} + size2[i];
    contexts[i] = static_cast<std::uint8_t>(first + energy_class(sum) * kDistances + distance_class(contexts[i]));
  }
}

template <class Code>
[[gnu::always_inline]] inline void settle_each(std::size_t count, const Code* __restrict predicted,
                                               const Code* __restrict flips, const Code* __restrict residuals,
                                               float scale, Code* __restrict heights, std::uint8_t* __restrict sizes) {
  for (std::size_t i = 0; i < count; ++i) {
    heights[i] = wrapped_sum(predicted[i], static_cast<Code>(residuals[i] ^ flips[i]));
    sizes[i] = Scale::size(residuals[i], scale);
  }
}

}  // namespace

TALUS_CLONES void expect_all(const Expectations<std::int32_t>& candidates, float scale, int kind) {
  expect_each(candidates, scale, kind);
}
TALUS_CLONES void expect_all(const Expectations<std::int64_t>& candidates, float scale, int kind) {
  expect_each(candidates, scale, kind);
}
TALUS_CLONES void settle_all(std::size_t count, const std::int32_t* predicted, const std::int32_t* flips,
                             const std::int32_t* residuals, float scale, std::int32_t* heights, std::uint8_t* sizes) {
  settle_each(count, predicted, flips, residuals, scale, heights, sizes);
}
TALUS_CLONES void settle_all(std::size_t count, const std::int64_t* predicted, const std::int64_t* flips,
                             const std::int64_t* residuals, float scale, std::int64_t* heights, std::uint8_t* sizes) {
  settle_each(count, predicted, flips, residuals, scale, heights, sizes);
}

}  // namespace talus
