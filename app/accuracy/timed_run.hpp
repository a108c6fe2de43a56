#pragma once
// This very program, asked as its user would ask it.

#include <optional>
#include <string>
#include <vector>

namespace talus::app {

/// Runs `talus` with arguments and --json in a process of its own, and reads how many seconds it says it took. Nothing
/// where that could not be done: what is told from it is no more than a remark.
[[nodiscard]] std::optional<double> seconds_of(std::vector<std::string> arguments);

}  // namespace talus::app
