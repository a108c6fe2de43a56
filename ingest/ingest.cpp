#include "talus/ingest.hpp"

#include <optional>
#include <span>

#include "engine/machine/fail.hpp"
#include "engine/page/manifest.hpp"
#include "ingest/job/job.hpp"
#include "ingest/job/left_work.hpp"
#include "ingest/job/part_file.hpp"
#include "ingest/job/plan.hpp"
#include "ingest/mosaic/input_files.hpp"

namespace talus {
namespace {

/// Whether a finished database has these inputs and options. An interrupted ingest may leave one without its seal or
/// its name. Its plan is gone, but its provenance remains.
bool was_made_of(const Provenance& made, const Source& source, const InputFiles& files, const IngestOptions& options) {
  if (made.made_by != made_by(options) || made.sources.size() != source.inputs().size()) return false;
  for (std::size_t i = 0; i < made.sources.size(); ++i) {
    const SourceFile& then = made.sources[i];
    const InputFile& now = source.inputs()[i];
    if (then.name != now.name || then.bytes != now.bytes || then.checksum != files.checksum(i)) return false;
  }
  return true;
}

/// Why an ingest cannot go on with what another one left; empty if it can.
std::string obstacle(const LeftWork& left, const std::string& plan, const Source& source, const InputFiles& files,
                     const IngestOptions& options) {
  if (left.kind == LeftWork::Kind::ingest) return difference_of(left.plan, plan);
  if (left.kind != LeftWork::Kind::finished) return "";
  return was_made_of(*left.made, source, files, options) ? "" : "it was made with other inputs or options";
}

/// Refuses to resume work of another plan.
void require_same_work(const LeftWork& left, const std::string& plan, const Source& source, const InputFiles& files,
                       const IngestOptions& options, const std::filesystem::path& part) {
  const std::string why = obstacle(left, plan, source, files, options);
  if (why.empty()) return;
  fail_in(part, Cause::invalid_argument, "{}: cannot be resumed: {}. Start again with IngestOptions::overwrite",
          part.string(), why);
}

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

/// Whether there is work to resume: tiles, or a finished file without its seal or its name.
bool holds_tiles(PageWriter& writer) {
  return writer.is_finished() || writer.committed().summary(kRecordTable).pages > 0;
}

/// The job of making a new database from a source.
Job job_of(const Source& source, const IngestOptions& options) {
  Description description = source.description();
  description.void_weight = options.void_weight;
  description.lossy = Metres{options.inputs.height_step.value / 2};
  description.finest_tolerance = Metres{options.finest_tolerance.value};
  description.error_metric = options.error_metric;
  return job_of(
      description, code_bytes(code_kind(source.description())), source.block_bytes(),
      [&source](Window& into, GridRect part, GridRect own) { source.read_into(into, part, own); }, options);
}

IngestReport ingest_all(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                        const IngestOptions& options) {
  const Source source(inputs, options.inputs);
  Job job = job_of(source, options);
  const auto left = options.resume      ? PartFile::Left::resume
                    : options.overwrite ? PartFile::Left::replace
                                        : PartFile::Left::refuse;
  PartFile part(database, options.overwrite, left);
  const auto tell = [&] { tell_of(job, "checksums of the inputs"); };
  const LeftWork left_before = part.left().value_or(LeftWork{});
  InputFiles files(source, files_of(left_before.plan), tell);
  const std::string plan = plan_of(source, files, job.description, options);
  if (part.left()) {
    require_same_work(left_before, plan, source, files, options, part.path());
    verify_left_work(part.path(), job.description, [&] { tell_of(job, "checking the interrupted work"); });
  }
  job.files = &files;
  std::optional<PageWriter> writer(std::in_place, part.path());
  // The plan is committed together with the first tiles.
  if (left_before.kind != LeftWork::Kind::finished) writer->put({kHeaderTable, kPlanPosition}, bytes_of(plan));
  IngestReport report;
  try {
    Provenance provenance;
    provenance.made_by = made_by(options);
    report = run(job, source, std::move(provenance), *writer);
  } catch (const Failure& f) {
    if (files.is_changed()) part.keep(false);  // tiles may mix old and new content
    if (f.cause() == Cause::full && holds_tiles(*writer)) part.keep();
    throw;
  } catch (...) {  // interrupted: finished tiles are kept
    if (!writer->is_finished()) writer->commit(true);
    if (holds_tiles(*writer)) part.keep();
    throw;
  }
  writer.reset();
  part.publish();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - job.started).count();
  return report;
}

IngestEstimate estimate_all(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                            const IngestOptions& options) {
  require_target(database, options.overwrite, 0);
  const Source source(inputs, options.inputs);
  const Job job = job_of(source, options);
  IngestEstimate sum =
      estimate(job, source, [&](TileId id) { return source.touches(tile_window(id, job.description.extent)); });
  require_target(database, options.overwrite, sum.bytes);
  return sum;
}

}  // namespace

IngestReport ingest(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                    const IngestOptions& options) {
  return within_memory([&] { return ingest_all(inputs, database, options); });
}

IngestEstimate estimate_ingest(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                               const IngestOptions& options) {
  return within_memory([&] { return estimate_all(inputs, database, options); });
}

IngestReport ingest(const std::filesystem::path& input, const std::filesystem::path& database,
                    const IngestOptions& options) {
  return ingest(std::vector{input}, database, options);
}

}  // namespace talus
