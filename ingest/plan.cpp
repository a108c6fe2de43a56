#include "ingest/plan.hpp"

#include <span>

#include <fmt/format.h>

#include "engine/manifest.hpp"

namespace talus {

std::vector<std::byte> plan_of(const Source& source, const Description& d, const IngestOptions& options) {
  std::string text = fmt::format("talus format {}\nextent {} {} {} {}\nmapping {} {} {} {}\nvoid weight {}\n",
                                 kFormatVersion, d.extent.first.col, d.extent.first.row, d.extent.last.col,
                                 d.extent.last.row, d.mapping.x0, d.mapping.y0, d.mapping.dx, d.mapping.dy,
                                 options.void_weight);
  text += fmt::format("step {} {} {} {}\ncrs {}\n", d.step.scale, d.step.divisor, d.step.offset, d.step.integer, d.crs_wkt);
  for (const InputFile& input : source.inputs())
    text += fmt::format("input {} {} bytes, changed {}\n", input.name, input.bytes, input.modified_ns);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::string made_by(const IngestOptions& options) {
  std::string text = "talus " TALUS_VERSION;
  if (options.void_weight != 1) text += fmt::format(", --void-weight {}", options.void_weight);
  return text;
}

}  // namespace talus
