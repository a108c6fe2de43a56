#include <algorithm>
#include <span>

#include "engine/machine/fail.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "ingest/job/changes.hpp"
#include "ingest/job/existing_database.hpp"
#include "ingest/job/job.hpp"
#include "ingest/job/part_file.hpp"
#include "ingest/job/plan.hpp"
#include "ingest/job/sound_file.hpp"
#include "ingest/mosaic/common_grid.hpp"
#include "ingest/mosaic/input_files.hpp"

namespace talus {
namespace {

/// The samples after the update: the new ones, and the old ones where the new ones are void.
Window laid_over(const ExistingDatabase& base, const Source& source, std::size_t kind, GridRect part) {
  Window window{part, codes_of_kind(kind, static_cast<std::size_t>(part.samples())), {}};
  window.valid.assign(static_cast<std::size_t>(part.samples()), 0);
  const GridRect fresh = common(part, source.description().extent);
  if (!is_empty(fresh)) {
    const Window read = source.read(fresh);
    const CodeSpan codes = view(read.codes);
    for_each_point(fresh, [&](GridPoint p) {
      const std::size_t from = index_in(fresh, p), to = index_in(part, p);
      if (!read.valid.empty() && !read.valid[from]) return;
      window.valid[to] = 1;
      set_code(window.codes, to, code_at(codes, from));
    });
  }
  base.fill(window);
  if (std::find(window.valid.begin(), window.valid.end(), 0) == window.valid.end()) window.valid.clear();
  return window;
}

void require_same_heights(const Description& base, const Description& fresh) {
  if (base.step == fresh.step && base.metres_per_unit == fresh.metres_per_unit) return;
  fail(Cause::unsupported,
       "{}: one unit of its numbers is {} {}, one unit of the database's is {} {}. Convert the new data first "
       "(gdal_translate -scale or -unscale)",
       fresh.source_name, fresh.step.scale / fresh.step.divisor, fresh.vertical_unit,
       base.step.scale / base.step.divisor, base.vertical_unit);
}

void require_all_samples(const Description& base, const std::filesystem::path& database) {
  if (base.finest_tolerance.value == 0) return;
  fail(Cause::unsupported,
       "{}: keeps only the vertices for tolerances of {} m and more, so errors beside new data cannot be computed. "
       "Ingest all sources again",
       database.string(), base.finest_tolerance.value);
}

/// A database, its new inputs, and what they change.
struct Updating {
  Updating(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
           const IngestOptions& asked)
      : base(database),
        before(base.manifest().description),
        options(asked_of(before, database, asked)),
        source(inputs, options.inputs),
        description(before) {
    require_same_heights(before, source.description());
    description.extent = around(before.extent, source.description().extent);
    kind = std::max(code_kind(before), code_kind(source.description()));
    if (kind > code_kind(before)) description.source_type = source.description().source_type;
  }

  [[nodiscard]] Job job() const {
    Job made = job_of(
        description, code_bytes(kind), source.block_bytes(),
        [this](Window& into, GridRect part, GridRect) { into = laid_over(base, source, kind, part); }, options);
    made.is_stale = [this](TileId id) { return is_stale(id); };
    return made;
  }
  [[nodiscard]] bool is_stale(TileId id) const {
    const GridRect window = tile_window(id, description.extent);
    return changes.touches(window) || !(window == tile_window(id, before.extent));
  }
  /// Finds what changes. Reads the new samples and the old ones under them.
  void compare(const Job& job) {
    const RasterCache cache(job.budget.gdal_cache_bytes);
    changes =
        changes_by(base, source, kind, job.budget.tiles_across, [&] { tell_of(job, "comparing with the database"); });
  }
  [[nodiscard]] bool changes_nothing() const { return changes.sum.samples == 0 && description.extent == before.extent; }

  ExistingDatabase base;
  const Description& before;
  IngestOptions options;
  Source source;
  Description description;
  std::size_t kind = 0;
  Changes changes;

 private:
  static IngestOptions asked_of(const Description& before, const std::filesystem::path& database,
                                const IngestOptions& asked) {
    require_all_samples(before, database);
    IngestOptions options = asked;
    options.void_weight = before.void_weight;
    options.error_metric = before.error_metric;
    options.inputs.grid = grid_of(before);
    options.inputs.height_step = Metres{2 * before.lossy.value};
    return options;
  }
};

/// Resampled rasters of an update were not interpolated together with the first ones.
void add_note_of_joints(const Source& source, std::vector<std::string>& notes) {
  const auto& inputs = source.inputs();
  if (std::none_of(inputs.begin(), inputs.end(), [](const InputFile& input) { return input.is_resampled; })) return;
  notes.push_back(
      "the new rasters were resampled without their neighbours in the database: beside the joint, heights are "
      "interpolated from one side only. Ingest all rasters together to interpolate across it");
}

IngestReport update_all(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                        const IngestOptions& asked) {
  const auto started = std::chrono::steady_clock::now();
  static_cast<void>(PageStore::open(followed(database)));  // refuses a missing database before any file is made
  // From here on no other process writes. Readers keep their file; the new one takes the name at the end.
  PartFile part(database, true, asked.overwrite ? PartFile::Left::replace : PartFile::Left::refuse);
  require_sound_file(part.target());
  Updating work(inputs, part.target(), asked);
  part.require_database_unchanged();  // it was checked in this state
  Job job = work.job();
  const auto tell = [&] { tell_of(job, "checksums of the inputs"); };
  InputFiles files(work.source, {}, tell);
  work.compare(job);
  job.files = &files;
  IngestReport report;
  if (work.changes_nothing()) {
    files.require_unchanged(tell);
    report.description = work.before;
    report.bytes = std::filesystem::file_size(part.target());
    report.notes = work.source.notes();
  } else {
    Provenance provenance = work.base.provenance();
    const std::uint32_t now = ++provenance.generation;
    provenance.made_by = made_by(work.options);
    job.making.generation = [&, now](PageKey key, std::span<const std::byte> content) {
      return work.base.generation_of(key, content, now);
    };
    part.copy_database();
    PageWriter writer(part.path());
    const std::string plan = plan_of_update(database, work.source);
    writer.put({kHeaderTable, kPlanPosition}, std::as_bytes(std::span(plan)), now);
    writer.commit(true);  // from now on the file is known as an update's
    report = run(job, work.source, std::move(provenance), writer);
    part.publish();
  }
  add_note_of_joints(work.source, report.notes);
  report.change = work.changes.sum;
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return report;
}

IngestEstimate estimate_all(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                            const IngestOptions& options) {
  static_cast<void>(PageStore::open(followed(database)));
  require_target(database, true, 0);
  require_sound_file(followed(database));
  Updating work(inputs, followed(database), options);
  const Job job = work.job();
  work.compare(job);
  IngestEstimate sum = estimate(job, work.source, [&](TileId id) { return work.is_stale(id); });
  add_note_of_joints(work.source, sum.notes);
  sum.change = work.changes.sum;
  const std::uint64_t bytes = std::filesystem::file_size(followed(database));
  sum.bytes = work.changes_nothing() ? bytes : bytes + sum.bytes;
  if (work.changes_nothing()) sum.tiles = 0, sum.seconds = 0;
  require_target(database, true, work.changes_nothing() ? 0 : sum.bytes);
  return sum;
}

}  // namespace

IngestReport update(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                    const IngestOptions& options) {
  return within_memory([&] { return update_all(inputs, database, options); });
}

IngestEstimate estimate_update(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                               const IngestOptions& options) {
  return within_memory([&] { return estimate_all(inputs, database, options); });
}

}  // namespace talus
