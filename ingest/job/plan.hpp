#pragma once
// What an ingest or update was asked to do, as text: an interrupted ingest is gone on with only for the same.

#include <cstddef>
#include <string>
#include <vector>

#include "ingest/mosaic/input_files.hpp"
#include "ingest/mosaic/source.hpp"
#include "talus/ingest.hpp"

namespace talus {

/// Everything that the content of the database depends on: grid, options, and each file behind the inputs with its
/// size, times and digest.
[[nodiscard]] std::string plan_of(const Source& source, const InputFiles& files, const Description& description,
                                  const IngestOptions& options);
/// Of an update. It is never gone on with, and says so in its first line.
[[nodiscard]] std::string plan_of_update(const std::filesystem::path& database, const Source& source);

[[nodiscard]] bool is_plan_of_ingest(const std::string& plan);
[[nodiscard]] std::string title_of(const std::string& plan);
/// The files that a plan lists; empty for text that is no plan.
[[nodiscard]] std::vector<DigestedFile> files_of(const std::string& plan);

/// Why work on one plan cannot go on with another one: a sentence that names the file or says that options differ.
/// Empty if it can: times of files, and folders, may differ.
[[nodiscard]] std::string difference_of(const std::string& then, const std::string& now);

/// The options that matter to the content, as one would type them: "talus 0.1, --void-weight 2".
[[nodiscard]] std::string made_by(const IngestOptions& options);

}  // namespace talus
