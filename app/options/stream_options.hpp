#pragma once
// How .rqt files are to be written, on the command line.

#include <string>

#include <CLI/CLI.hpp>

#include "talus/question.hpp"
#include "talus/stream.hpp"

namespace talus::app {

struct StreamWords {
  std::string profile = "balanced";
  int bands = 0;
};

void add_stream_words(CLI::App* command, StreamWords& words);
/// What heights an answer has: exact ones, or multiples of a quantum.
struct HeightWords {
  std::string kind = "exact", quantum;

  /// Fails with invalid_argument, naming option and value.
  [[nodiscard]] Heights heights() const;
};
void add_height_words(CLI::App* command, HeightWords& words);

/// Fails with invalid_argument, naming option and value.
[[nodiscard]] StreamOptions stream_options(const StreamWords& words, int threads = 0);
[[nodiscard]] std::string spelled(StreamProfile profile);

}  // namespace talus::app
