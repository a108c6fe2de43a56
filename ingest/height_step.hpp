#pragma once
// Float sources that sit on a step become whole numbers.

#include <vector>

#include "talus/description.hpp"

namespace talus {

/// If every valid height is a whole number, or, in Float64, a decimal of at most three places, turns the
/// codes into those whole numbers and returns their step, which restores every value bit for bit.
/// Otherwise leaves codes and step as they are. Float32 decimals stay floats: the distance between such
/// a value and its decimal would break the promise at tolerances that errors hit exactly
/// (docs/decisions/0002-heights.md).
[[nodiscard]] HeightStep find_height_step(const Description& source, std::vector<double>& codes,
                                          const std::vector<std::uint8_t>& valid);

}  // namespace talus
