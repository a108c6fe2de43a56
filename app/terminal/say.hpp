#pragma once
// Lines on standard error. If it is full or closed, nothing happens.

#include <string>
#include <string_view>
#include <vector>

namespace talus::app {

/// "talus: SENTENCE" on its own line; names of fields become options, see with_options.
void say(std::string sentence);
/// "talus: note: SENTENCE".
void note(const std::string& sentence);
void notes(const std::vector<std::string>& sentences);

/// Overwrites the line of progress, which stays open until something else is said.
void show_progress(std::string_view line);
/// Ends that line, if it is open. A signal handler may call it.
void end_progress() noexcept;

/// Writes bytes as they are.
void write_to_log(std::string_view text) noexcept;

}  // namespace talus::app
