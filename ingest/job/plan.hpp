#pragma once
// Plans: inputs and options of an ingest or update as text. An ingest is resumed only if its plan is the same.

#include <cstddef>
#include <string>
#include <vector>

#include "ingest/mosaic/input_files.hpp"
#include "ingest/mosaic/source.hpp"
#include "talus/ingest.hpp"

namespace talus {

/// Everything that the content depends on: grid, options, and each input file with its size, times and digest.
[[nodiscard]] std::string plan_of(const Source& source, const InputFiles& files, const Description& description,
                                  const IngestOptions& options);
/// The plan of an update. Its first line marks it as such, because it is never resumed.
[[nodiscard]] std::string plan_of_update(const std::filesystem::path& database, const Source& source);

[[nodiscard]] bool is_plan_of_ingest(const std::string& plan);
[[nodiscard]] std::string title_of(const std::string& plan);
/// The files in a plan; empty if the text is not a plan.
[[nodiscard]] std::vector<DigestedFile> files_of(const std::string& plan);

/// Why the work of one plan cannot continue under another: names the file, or says that options differ. Empty if it
/// can: times and folders of files may differ.
[[nodiscard]] std::string difference_of(const std::string& then, const std::string& now);

/// Program version and the options that change the content: "talus 0.1, IngestOptions::void_weight 2".
[[nodiscard]] std::string made_by(const IngestOptions& options);

}  // namespace talus
