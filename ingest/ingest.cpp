#include "talus/ingest.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "engine/manifest.hpp"
#include "ingest/job.hpp"
#include "ingest/part_file.hpp"
#include "ingest/plan.hpp"

namespace talus {
namespace {

/// Of a database that was finished and lacked only its seal or its name when the ingest was cut short: its plan is gone,
/// but it says what it was made from.
bool was_made_of(const Provenance& made, const Source& source, const IngestOptions& options) {
  if (made.made_by != made_by(options) || made.sources.size() != source.inputs().size()) return false;
  for (std::size_t i = 0; i < made.sources.size(); ++i) {
    const SourceFile& then = made.sources[i];
    const InputFile& now = source.inputs()[i];
    if (then.name != now.name || then.bytes != now.bytes || then.checksum != source.checksum(i)) return false;
  }
  return true;
}

/// Puts down what is to be done, or holds it against what an interrupted ingest had put down.
void agree_on_plan(PageWriter& writer, const std::vector<std::byte>& plan, const Source& source,
                   const IngestOptions& options, const std::filesystem::path& part) {
  {
    const ReadTxn view = writer.committed();
    if (const auto left = view.find({kHeaderTable, kPlanPosition})) {
      if (std::equal(plan.begin(), plan.end(), left->content.begin(), left->content.end())) return;
      const auto made = view.find({kHeaderTable, kProvenancePosition});
      if (left->content.empty() && made && was_made_of(decode_provenance(made->content), source, options)) return;
      throw Failure(Cause::invalid_argument,
                    fmt::format("{}: was begun with other inputs or options, or they have changed since; go on with "
                                "those, or start anew without --resume by --overwrite",
                                part.string()));
    }
  }
  writer.put({kHeaderTable, kPlanPosition}, plan);  // with the first tiles: small files have few transactions
}

/// Whether there is work to go on with: tiles, or a file that lacks its seal or its name only.
bool holds_tiles(PageWriter& writer) {
  return writer.is_finished() || writer.committed().summary(kRecordTable).pages > 0;
}

}  // namespace

IngestReport ingest(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                    const IngestOptions& options) {
  const Source source(inputs, options.inputs);
  Description description = source.description();
  description.void_weight = options.void_weight;
  description.lossy_metres = options.inputs.height_step / 2;
  description.finest_tolerance = options.finest_tolerance;
  description.error_kind = options.error_kind;
  description.error_metric = options.error_metric;
  Job job = job_of(
      description, code_bytes(code_kind(source.description())), source.block_bytes(),
      [&](Window& into, GridRect part, GridRect own) { source.read_into(into, part, own); }, options);
  const auto left = options.resume      ? PartFile::Left::resume
                    : options.overwrite ? PartFile::Left::replace
                                        : PartFile::Left::refuse;
  PartFile part(database, options.overwrite, left);
  std::optional<PageWriter> writer(std::in_place, part.path());
  if (options.resume) part.keep();  // whatever happens now, what was there stays
  agree_on_plan(*writer, plan_of(source, job.description, options), source, options, part.path());
  IngestReport report;
  try {
    report = run(job, source, {{}, made_by(options), 0, {}}, *writer);
  } catch (const Failure& f) {
    if (f.cause() == Cause::full && holds_tiles(*writer)) part.keep();
    throw;
  } catch (...) {  // interrupted: what is done is worth keeping
    if (!writer->is_finished()) writer->commit(true);
    if (holds_tiles(*writer)) part.keep();
    throw;
  }
  writer.reset();
  part.publish();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - job.started).count();
  return report;
}

IngestEstimate estimate_ingest(const std::vector<std::filesystem::path>& inputs, const IngestOptions& options) {
  const Source source(inputs, options.inputs);
  Description description = source.description();
  description.void_weight = options.void_weight;
  description.lossy_metres = options.inputs.height_step / 2;
  description.finest_tolerance = options.finest_tolerance;
  description.error_kind = options.error_kind;
  description.error_metric = options.error_metric;
  return estimate(job_of(description, code_bytes(code_kind(source.description())), source.block_bytes(),
                         [&](Window& into, GridRect part, GridRect own) { source.read_into(into, part, own); }, options),
                  source);
}

IngestReport ingest(const std::filesystem::path& input, const std::filesystem::path& database,
                    const IngestOptions& options) {
  return ingest(std::vector{input}, database, options);
}

}  // namespace talus
