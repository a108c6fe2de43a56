#include "ingest/raster/height_coding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/machine/fail.hpp"

namespace talus {

template <class T>
SureHeights<T> sure_heights(const RasterFacts& facts, const RasterCoding& coding) {
  if (coding.rule != RasterCoding::Rule::raw) return {std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max()};
  // Kept a little inside the largest heights, so that rounding does not pass them.
  const HeightStep& step = coding.step;
  const double scale = step.integer ? step.scale / step.divisor : 1, offset = step.integer ? step.offset : 0;
  const double largest = kLargestHeight / facts.metres_per_unit * (1 - 1e-9);
  const double a = (-largest - offset) / scale, b = (largest - offset) / scale;
  const auto held = [](double v) {
    return static_cast<T>(
        std::clamp(std::trunc(v), double{std::numeric_limits<T>::lowest()}, double{std::numeric_limits<T>::max()}));
  };
  return {held(std::min(a, b)), held(std::max(a, b))};
}

template <class T>
void code_heights(const Patch<T>& patch, const Patch<std::uint8_t>& valid, const RasterFacts& facts,
                  const RasterCoding& coding, GridPoint first) {
  const SureHeights<T> sure = sure_heights<T>(facts, coding);
  const double largest = kLargestHeight / facts.metres_per_unit;
  const bool is_integer = facts.is_integer();
  const HeightStep own{facts.scale, 1, facts.offset, true}, step = coding.step;
  const auto value_of = [&](double raw) {
    if (is_integer) return own.value(raw);
    const double scaled = raw * facts.scale;
    return facts.offset != 0 ? scaled + facts.offset : scaled;  // -0.0 + 0 is 0
  };
  for (std::size_t r = 0; r < patch.rows; ++r) {
    T* row = patch.row(r);
    const std::uint8_t* ok = valid.row(r);
    for (std::size_t c = 0; c < patch.cols; ++c) {
      if (ok[c] == 0 || (coding.rule == RasterCoding::Rule::raw && row[c] >= sure.low && row[c] <= sure.high)) continue;
      const double value = value_of(static_cast<double>(row[c]));
      if (!(std::abs(value) <= largest)) {
        fail_in(facts.name, Cause::invalid_argument,
                "{} holds {} {} at column {}, row {}; heights lie within {} m up or down. If the value means no data, "
                "declare it: with InputOptions::nodata if the file declares no void value, else with gdal_translate "
                "-a_nodata",
                facts.name, value, facts.vertical_unit, first.col + static_cast<std::int64_t>(c),
                first.row + static_cast<std::int64_t>(r), kLargestHeight);
      }
      if (coding.rule == RasterCoding::Rule::value) row[c] = static_cast<T>(value);
      if (coding.rule == RasterCoding::Rule::rounded) {
        row[c] = static_cast<T>(std::nearbyint((value - step.offset) * step.divisor / step.scale) + 0.0);
      }
    }
  }
}

template SureHeights<std::int16_t> sure_heights(const RasterFacts&, const RasterCoding&);
template SureHeights<float> sure_heights(const RasterFacts&, const RasterCoding&);
template SureHeights<double> sure_heights(const RasterFacts&, const RasterCoding&);
template void code_heights(const Patch<std::int16_t>&, const Patch<std::uint8_t>&, const RasterFacts&,
                           const RasterCoding&, GridPoint);
template void code_heights(const Patch<float>&, const Patch<std::uint8_t>&, const RasterFacts&, const RasterCoding&,
                           GridPoint);
template void code_heights(const Patch<double>&, const Patch<std::uint8_t>&, const RasterFacts&, const RasterCoding&,
                           GridPoint);

}  // namespace talus
