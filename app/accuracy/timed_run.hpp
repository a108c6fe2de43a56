#pragma once
// Runs this program as a user would.

#include <optional>
#include <string>
#include <vector>

namespace talus::app {

/// Runs `talus` with these arguments and --json in a new process.
/// returns  the seconds that it reports; empty where that failed
[[nodiscard]] std::optional<double> seconds_of(std::vector<std::string> arguments);

}  // namespace talus::app
