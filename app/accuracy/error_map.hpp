#pragma once
// Where the error sits, as pictures in an SVG.

#include <string>

#include "app/accuracy/chart.hpp"
#include "talus/accuracy.hpp"

namespace talus::app {

/// The maps of a report side by side, with a legend, a scale and, if there are several, where they lie. The relief is
/// shaded from the samples, the colour says how far the surface lies above or below them.
/// fails  as png_bytes
[[nodiscard]] std::string drawn_maps(const AccuracyReport& report, Box box);

}  // namespace talus::app
