#pragma once
// How rasters are read: the same words for all commands that read them.

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "talus/ingest.hpp"

namespace talus::app {

/// As they were typed.
struct InputWords {
  std::vector<std::string> nodata;
  std::string decode = "none";
  InputOptions options;  ///< what needs no reading

  /// fails  invalid_argument: a word that means nothing
  [[nodiscard]] InputOptions read() const;
};

void add_input_options(CLI::App& command, InputWords& words);

}  // namespace talus::app
