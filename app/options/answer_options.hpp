#pragma once
// Options for .rqt files, and for the heights and the border of an answer.

#include "app/options/command.hpp"
#include "talus/question.hpp"
#include "talus/stream.hpp"

namespace talus::app {

void add_stream_options(Command& command, StreamOptions& options);
void add_height_options(Command& command, Heights& heights);
void add_border_option(Command& command, Border& border);

[[nodiscard]] const char* name_of(Border border);

}  // namespace talus::app
