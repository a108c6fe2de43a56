#pragma once
// Standard input, output and error.

#include <cstddef>
#include <span>

namespace talus::app {

/// Opens a substitute for each of the three that is closed, so that no later file becomes standard output by accident.
/// From now on, a write fails where a limit on file sizes or a closed pipe would send a signal.
void secure_standard_files();

/// Waits for bytes, and reads at most as many as there is room for; 0 at the end.
/// fails  io
[[nodiscard]] std::size_t read_standard_input(std::span<std::byte> room);

}  // namespace talus::app
