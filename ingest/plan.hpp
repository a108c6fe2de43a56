#pragma once
// What an ingest was asked to do, as text: an interrupted one is gone on with only for the same.

#include <cstddef>
#include <vector>

#include "ingest/source.hpp"
#include "talus/ingest.hpp"

namespace talus {

/// Everything that the content of the database depends on: inputs with size and time of change, grid, options.
[[nodiscard]] std::vector<std::byte> plan_of(const Source& source, const Description& description,
                                             const IngestOptions& options);

/// The options that matter to the content, as one would type them: "talus 0.1, --void-weight 2".
[[nodiscard]] std::string made_by(const IngestOptions& options);

}  // namespace talus
