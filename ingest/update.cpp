#include <algorithm>
#include <optional>
#include <variant>

#include <fmt/format.h>

#include "ingest/base.hpp"
#include "ingest/job.hpp"
#include "ingest/part_file.hpp"
#include "ingest/plan.hpp"

namespace talus {
namespace {

GridRect around(GridRect a, GridRect b) {
  return {{std::min(a.first.col, b.first.col), std::min(a.first.row, b.first.row)},
          {std::max(a.last.col, b.last.col), std::max(a.last.row, b.last.row)}};
}
GridRect common(GridRect a, GridRect b) {
  return {{std::max(a.first.col, b.first.col), std::max(a.first.row, b.first.row)},
          {std::min(a.last.col, b.last.col), std::min(a.last.row, b.last.row)}};
}

Codes codes_of_kind(std::size_t kind, std::size_t n) {
  if (kind == 0) return std::vector<std::int16_t>(n);
  if (kind == 1) return std::vector<float>(n);
  return std::vector<double>(n);
}

/// The new samples over the old ones; what is void in the new does not cover.
Window laid_over(const Base& base, const Source& source, std::size_t kind, GridRect part, GridRect own) {
  Window window{part, codes_of_kind(kind, static_cast<std::size_t>(part.samples())), {}};
  window.valid.assign(static_cast<std::size_t>(part.samples()), 0);
  const GridRect fresh = common(part, source.description().extent);
  if (fresh.cols() > 0 && fresh.rows() > 0) {
    const Window read = source.read(fresh, common(own, fresh));
    for (std::int32_t row = fresh.first.row; row <= fresh.last.row; ++row) {
      for (std::int32_t col = fresh.first.col; col <= fresh.last.col; ++col) {
        const auto in = [&](GridRect r) {
          return static_cast<std::size_t>((std::int64_t{row} - r.first.row) * r.cols() + (col - r.first.col));
        };
        if (!read.valid.empty() && !read.valid[in(fresh)]) continue;
        window.valid[in(part)] = 1;
        std::visit(
            [&](auto& to, const auto& from) {
              to[in(part)] = static_cast<typename std::remove_reference_t<decltype(to)>::value_type>(from[in(fresh)]);
            },
            window.codes, read.codes);
      }
    }
  }
  base.fill(window);
  if (std::find(window.valid.begin(), window.valid.end(), 0) == window.valid.end()) window.valid.clear();
  return window;
}

void require_same_heights(const Description& base, const Description& fresh) {
  if (base.step == fresh.step && base.metres_per_unit == fresh.metres_per_unit) return;
  throw Failure(Cause::unsupported,
                fmt::format("{}: heights in {} of {}; the database has {} of {}: convert the new data first "
                            "(gdal_translate -scale or -unscale)",
                            fresh.source_name, fresh.step.scale / fresh.step.divisor, fresh.vertical_unit,
                            base.step.scale / base.step.divisor, base.vertical_unit));
}

void require_all_samples(const Description& base, const std::filesystem::path& database) {
  if (base.finest_tolerance == 0) return;
  throw Failure(Cause::unsupported,
                fmt::format("{}: keeps only the vertices of answers at {} m and more (--tolerance); beside new data errors "
                            "would be those of what is left: ingest the sources anew",
                            database.string(), base.finest_tolerance));
}

}  // namespace

IngestReport update(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                    const IngestOptions& asked) {
  const Base base(database);
  const Description& before = base.manifest().description;
  require_all_samples(before, database);
  IngestOptions options = asked;
  options.void_weight = before.void_weight;
  options.error_kind = before.error_kind;
  options.error_metric = before.error_metric;
  options.no_guarantee = true;  // said when the database was made
  options.inputs.grid = grid_of(before);
  options.inputs.height_step = 2 * before.lossy_metres;  // rounded as the rest
  const Source source(inputs, options.inputs);
  require_same_heights(before, source.description());

  Description description = before;
  description.extent = around(before.extent, source.description().extent);
  const std::size_t kind = std::max(code_kind(before), code_kind(source.description()));
  if (kind > code_kind(before)) description.source_type = source.description().source_type;
  Job job = job_of(
      description, code_bytes(kind), source.block_bytes(),
      [&](Window& into, GridRect part, GridRect own) { into = laid_over(base, source, kind, part, own); }, options);
  Provenance provenance = base.provenance();
  ++provenance.generation;
  provenance.made_by = made_by(options);
  const std::uint32_t now = provenance.generation;
  job.making.generation = [&base, now](PageKey key, std::span<const std::byte> content) {
    return base.generation_of(key, content, now);
  };
  job.is_stale = [&](TileId id) {
    const GridRect window = tile_window(id, description.extent);
    return source.touches(window) || !(window == tile_window(id, before.extent));
  };

  // Readers keep the file they have; the new one takes its name at the end, in one step.
  PartFile part(database, true, asked.overwrite ? PartFile::Left::replace : PartFile::Left::refuse);
  part.copy_database();
  std::optional<PageWriter> writer(std::in_place, part.path());
  IngestReport report = run(job, source, std::move(provenance), *writer);
  writer.reset();
  part.publish();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - job.started).count();
  return report;
}

}  // namespace talus
