#pragma once
// What goes to standard error: a line each. A standard error that is full or closed takes nothing, and changes nothing.

#include <string>
#include <string_view>
#include <vector>

namespace talus::app {

/// "talus: SENTENCE", on a line of its own whatever was shown before; fields become options, see with_options.
void say(std::string sentence);
/// "talus: note: SENTENCE".
void note(const std::string& sentence);
void notes(const std::vector<std::string>& sentences);

/// Progress that is written over: the line stays open until something else is said.
void show_progress(std::string_view line);
/// Ends that line, if it is open. A signal handler may call it.
void end_progress() noexcept;

/// Bytes as they are.
void write_to_log(std::string_view text) noexcept;

}  // namespace talus::app
