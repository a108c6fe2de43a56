#pragma once
// How .rqt files are to be written, on the command line.

#include <string>

#include "app/commands.hpp"
#include "talus/stream.hpp"

namespace talus::app {

struct StreamWords {
  std::string profile = "balanced";
  int bands = 0;
};

void add_stream_words(CLI::App* command, StreamWords& words);
/// Fails with invalid_argument, naming option and value.
[[nodiscard]] StreamOptions stream_options(const StreamWords& words, int threads = 1);
[[nodiscard]] std::string spelled(StreamProfile profile);

}  // namespace talus::app
