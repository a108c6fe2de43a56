#pragma once
// The subcommands. Each adds itself to the command line; the one that is chosen sets the action.

#include "app/options/command.hpp"

namespace talus::app {

void add_ingest(CLI::App& program, Action& action);
void add_query(CLI::App& program, Action& action);
void add_height(CLI::App& program, Action& action);
void add_profile(CLI::App& program, Action& action);
void add_info(CLI::App& program, Action& action);
void add_merge(CLI::App& program, Action& action);
void add_convert(CLI::App& program, Action& action);
void add_accuracy(CLI::App& program, Action& action);
void add_verify(CLI::App& program, Action& action);
void add_compact(CLI::App& program, Action& action);
/// Last: it prints the help of the others, and a page for each topic.
void add_help(CLI::App& program, Action& action);

/// The topics of `talus help`, a line each.
[[nodiscard]] std::string topics();

}  // namespace talus::app
