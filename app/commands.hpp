#pragma once
// The subcommands. Each adds itself to the command line and leaves behind what is to be done.

#include <functional>

#include <CLI/CLI.hpp>

namespace talus::app {

/// The exit codes, and there are no others.
enum class Exit : int { done = 0, failed = 1, usage = 2, corrupt = 3, full = 4, differs = 5, interrupted = 130 };

using Action = std::function<Exit()>;

void add_ingest(CLI::App& program, Action& action);
void add_compact(CLI::App& program, Action& action);
void add_info(CLI::App& program, Action& action);
void add_query(CLI::App& program, Action& action);
void add_height(CLI::App& program, Action& action);
void add_profile(CLI::App& program, Action& action);
void add_merge(CLI::App& program, Action& action);
void add_convert(CLI::App& program, Action& action);
void add_accuracy(CLI::App& program, Action& action);
void add_verify(CLI::App& program, Action& action);

}  // namespace talus::app
