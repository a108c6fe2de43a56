#pragma once
// How .rqt files are to be written, on the command line.

#include <string>

#include <CLI/CLI.hpp>

#include "talus/question.hpp"
#include "talus/stream.hpp"

namespace talus::app {

void add_stream_words(CLI::App* command, StreamOptions& options);

/// What heights an answer has: exact ones, or multiples of a quantum.
struct HeightWords {
  std::string kind = "exact", quantum;

  /// Fails with invalid_argument, naming option and value.
  [[nodiscard]] Heights heights() const;
};
void add_height_words(CLI::App* command, HeightWords& words);

}  // namespace talus::app
