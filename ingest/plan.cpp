#include "ingest/plan.hpp"

#include <span>
#include <string>

#include <fmt/format.h>

#include "engine/error_rule.hpp"
#include "engine/manifest.hpp"

namespace talus {

namespace {

/// The options that the content depends on beyond the inputs, as one would type them.
std::string typed(const IngestOptions& options) {
  const InputOptions& in = options.inputs;
  std::string text;
  if (options.finest_tolerance != 0) text += fmt::format(", --tolerance {}", options.finest_tolerance);
  if (options.error_kind != ErrorKind::exact) text += fmt::format(", --error {}", name_of(options.error_kind));
  if (options.error_metric != ErrorMetric::vertical) text += fmt::format(", --metric {}", name_of(options.error_metric));
  if (options.void_weight != 1) text += fmt::format(", --void-weight {}", options.void_weight);
  if (!in.srs.empty()) text += fmt::format(", --srs {}", in.srs);
  if (in.band != 0) text += fmt::format(", --band {}", in.band);
  if (!in.variable.empty()) text += fmt::format(", --variable {}", in.variable);
  for (const double value : in.nodata) text += fmt::format(", --nodata {}", value);
  if (in.decode != ColourCode::none)
    text += fmt::format(", --decode {}", in.decode == ColourCode::terrarium ? "terrarium" : "terrain-rgb");
  if (!in.vertical_unit.empty()) text += fmt::format(", --vertical-unit {}", in.vertical_unit);
  if (in.priority_resolution) text += ", --priority resolution";
  if (!in.target_srs.empty()) text += fmt::format(", --t-srs {}", in.target_srs);
  if (in.target_dx != 0) text += fmt::format(", --tr {},{}", in.target_dx, in.target_dy);
  if (!in.resampling.empty()) text += fmt::format(", --resampling {}", in.resampling);
  if (in.height_step != 0) text += fmt::format(", --height-step {}", in.height_step);
  return text;
}

}  // namespace

std::vector<std::byte> plan_of(const Source& source, const Description& d, const IngestOptions& options) {
  std::string text = fmt::format("talus format {}\noptions{}\n", kFormatVersion, typed(options));
  text += fmt::format("extent {} {} {} {}\nmapping {} {} {} {}\n", d.extent.first.col, d.extent.first.row,
                      d.extent.last.col, d.extent.last.row, d.mapping.x0, d.mapping.y0, d.mapping.dx, d.mapping.dy);
  text += fmt::format("step {} {} {} {}\nunit {} {}\ncrs {}\n", d.step.scale, d.step.divisor, d.step.offset,
                      d.step.integer, d.vertical_unit, d.metres_per_unit, d.crs_wkt);
  for (const InputFile& input : source.inputs())
    text += fmt::format("input {} {} bytes, changed {}\n", input.name, input.bytes, input.modified_ns);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::string made_by(const IngestOptions& options) { return "talus " TALUS_VERSION + typed(options); }

}  // namespace talus
