#pragma once
// `talus query --from`.

#include <string>
#include <vector>

#include "app/terminal/exit.hpp"
#include "talus/database.hpp"
#include "talus/stream.hpp"

namespace talus::app {

/// Writes the increment that a question asks for. Fails with invalid_argument where an output is no .rqt.
Exit write_increment(const Snapshot& now, const Question& question, const std::vector<std::string>& outputs,
                     const StreamOptions& options, bool json, bool explain);

}  // namespace talus::app
