#pragma once
// Options for reading rasters, the same for all commands that do.

#include "app/options/command.hpp"
#include "talus/ingest.hpp"

namespace talus::app {

void add_input_options(Command& command, InputOptions& inputs);

}  // namespace talus::app
