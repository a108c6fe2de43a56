#pragma once
// Options that several commands have.

#include "app/options/command.hpp"
#include "talus/ingest.hpp"
#include "talus/question.hpp"
#include "talus/stream.hpp"

namespace talus::app {

/// For reading rasters.
void add_input_options(Command& command, InputOptions& inputs);
/// For .rqt files.
void add_stream_options(Command& command, StreamOptions& options);
void add_height_options(Command& command, Heights& heights);
void add_border_option(Command& command, Border& border);

[[nodiscard]] const char* name_of(Border border);

}  // namespace talus::app
