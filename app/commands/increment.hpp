#pragma once
// `talus query --from`.

#include <string>
#include <vector>

#include "app/terminal/exit.hpp"
#include "talus/database.hpp"
#include "talus/stream.hpp"

namespace talus::app {

/// Writes what an answer at `from` lacks of one at `to`. Fails with invalid_argument where an output is no .rqt.
Exit write_increment(const Snapshot& now, GridRect region, Metres from, Metres to, Metres quantum,
                     const std::vector<std::string>& outputs, const StreamOptions& options, bool json, bool explain);

}  // namespace talus::app
