#include "talus/ingest.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include <fmt/format.h>
#include <unistd.h>

#include "engine/saturation.hpp"
#include "ingest/ground.hpp"
#include "ingest/pack.hpp"
#include "ingest/part_file.hpp"
#include "ingest/source.hpp"
#include "storage/page_store.hpp"

namespace talus {
namespace {

/// Says beforehand what would otherwise end in the system's killing the process half-way.
void require_memory(const Description& d) {
  // Heights, masks of voids, slabs and GDAL by sample; errors and what triangles hold by vertex, rim included.
  constexpr double kPerSample = 16, kPerVertex = 5, kRim = 9;
  const double needed =
      static_cast<double>(d.extent.samples()) * kPerSample +
      (static_cast<double>(d.extent.cols()) + kRim) * (static_cast<double>(d.extent.rows()) + kRim) * kPerVertex;
  const double there = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (needed > there) {
    constexpr double kGiB = 1 << 30;
    throw Failure(Cause::unsupported,
                  fmt::format("{}: {} × {} samples take about {:.0f} GiB of memory to ingest, this machine has {:.0f}; "
                              "cut the raster into parts (gdal_translate -srcwin)",
                              d.source_name, d.extent.cols(), d.extent.rows(), std::ceil(needed / kGiB), there / kGiB));
  }
}

/// Heights and voids of the whole raster, and what they are measured in.
struct Heights {
  std::vector<double> codes;
  std::vector<std::uint8_t> valid;  // empty: all data
};

Heights read(const Source& source, Description& d, const std::function<void(double)>& progress) {
  Heights all;
  all.codes.reserve(static_cast<std::size_t>(d.extent.samples()));
  all.valid.reserve(all.codes.capacity());
  const auto rows_at_once =
      static_cast<std::int32_t>(std::clamp<std::int64_t>((1 << 22) / d.extent.cols(), 1, d.extent.rows()));
  for (std::int32_t row = d.extent.first.row; row <= d.extent.last.row; row += rows_at_once) {
    const std::int32_t last = std::min(row + rows_at_once - 1, d.extent.last.row);
    const Window window = source.read({{d.extent.first.col, row}, {d.extent.last.col, last}});
    std::visit([&](const auto& codes) { all.codes.insert(all.codes.end(), codes.begin(), codes.end()); }, window.codes);
    all.valid.insert(all.valid.end(), window.valid.begin(), window.valid.end());
    all.valid.resize(all.codes.size(), 1);
    progress(static_cast<double>(last - d.extent.first.row + 1) / static_cast<double>(d.extent.rows()));
  }
  d.void_samples = static_cast<std::uint64_t>(std::count(all.valid.begin(), all.valid.end(), 0));
  if (d.void_samples == all.valid.size()) {
    throw Failure(Cause::invalid_argument, fmt::format("{}: all {} samples are void; there is nothing to ingest",
                                                       d.source_name, d.void_samples));
  }
  if (d.void_samples == 0) all.valid.clear();
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::size_t i = 0; i < all.codes.size(); ++i) {
    if (!all.valid.empty() && !all.valid[i]) continue;
    const double height = d.step.value(all.codes[i]);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  d.minimum = lowest;
  d.maximum = highest;
  return all;
}

}  // namespace

IngestReport ingest(const std::filesystem::path& input, const std::filesystem::path& database,
                    const IngestOptions& options) {
  const auto started = std::chrono::steady_clock::now();
  const auto tell = [&](double fraction, const char* stage) {
    if (options.progress) options.progress(fraction, stage);
  };
  if (!(options.void_weight >= 0) || options.void_weight > 1e6) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("void weight {}: expected a number from 0 to 1000000", options.void_weight));
  }
  const Source source({input}, {});
  Manifest manifest;
  Description& d = manifest.description;
  d = source.description();
  d.void_weight = options.void_weight;
  require_memory(d);
  PartFile part(database, options.overwrite);

  Heights heights = read(source, d, [&](double f) { tell(0.3 * f, "reading"); });
  std::optional<VoidMap> voids;
  if (!heights.valid.empty()) {
    voids.emplace(d.extent, heights.valid);
    fill_voids(d.extent, heights.valid, *voids, heights.codes);
  }
  tell(0.35, "errors");

  const GroundScale ground = ground_scale(d);
  ErrorInput input_of_errors;
  input_of_errors.field = {d.extent,
                           heights.codes,
                           heights.valid,
                           CodeDistance(d.step, d.metres_per_unit),
                           interpolation_is_exact(heights.codes, root_side(d.extent)),
                           are_whole_numbers(heights.codes)};
  input_of_errors.voids = voids ? &*voids : nullptr;
  input_of_errors.ground_side = [&](const HalfDiamond& t) { return ground.longest_side(t).value; };
  input_of_errors.void_weight = options.void_weight;
  LevelGrid<ErrorCode> errors = vertex_errors(input_of_errors);
  tell(0.6, "errors");
  saturate(input_of_errors, errors);
  tell(0.65, "writing");

  manifest.bands = band_count(d.extent);
  manifest.exact = input_of_errors.field.exact;
  IngestReport report;
  PageWriter writer(part.path());
  const double expected = static_cast<double>(pages_of_band(0, d.extent).size()) * 1.05 + 1;
  pack({manifest, input_of_errors, errors, heights.valid}, [&](const Page& page) {
    writer.put({page.id.band, curve_position(page.id)}, encode(page));
    ++report.pages;
    tell(0.65 + 0.34 * std::min(1.0, static_cast<double>(report.pages) / expected), "writing");
  });
  writer.put({kHeaderTable, 0}, encode(manifest));
  report.bytes = writer.finish();
  part.publish();
  tell(1, "done");
  report.description = d;
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return report;
}

}  // namespace talus
