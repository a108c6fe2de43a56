#pragma once
// Maps of the error in an SVG.

#include <string>

#include "app/accuracy/chart.hpp"
#include "talus/accuracy.hpp"

namespace talus::app {

/// The maps of a report side by side, with a legend and a scale; several maps also get an overview. Shades are the
/// relief of the samples; colours say how far the surface lies above or below them.
/// fails  as png_bytes
[[nodiscard]] std::string drawn_maps(const AccuracyReport& report, Box box);

}  // namespace talus::app
