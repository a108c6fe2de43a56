#pragma once
// How .rqt files are to be written, on the command line.

#include <string>

#include <CLI/CLI.hpp>

#include "talus/stream.hpp"

namespace talus::app {

struct StreamWords {
  std::string profile = "balanced";
  int bands = 0;
};

void add_stream_words(CLI::App* command, StreamWords& words);
/// What heights an answer has: exact ones, or multiples of a quantum.
struct HeightWords {
  std::string heights = "exact", quantum;

  [[nodiscard]] bool are_exact() const { return heights == "exact"; }
  [[nodiscard]] bool are_fitted() const { return heights == "fitted"; }
  [[nodiscard]] bool are_dense() const { return heights == "dense"; }
  /// 0: none was given. Fails with invalid_argument, naming option and value.
  [[nodiscard]] Metres step() const;
};
void add_height_words(CLI::App* command, HeightWords& words);

/// Fails with invalid_argument, naming option and value.
[[nodiscard]] StreamOptions stream_options(const StreamWords& words, int threads = 1);
[[nodiscard]] std::string spelled(StreamProfile profile);

}  // namespace talus::app
