#pragma once
// The subcommands. Each adds itself to the command line and leaves behind what is to be done.

#include <functional>

#include <CLI/CLI.hpp>

#include "app/terminal/exit.hpp"

namespace talus::app {

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
