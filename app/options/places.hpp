#pragma once
// What the command line asks to be vertices, and where it wants which tolerance.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "talus/question.hpp"

namespace talus::app {

/// --point, --points, --line, --lines: as they were written.
struct Interest {
  std::vector<std::string> points, point_files, lines, line_files;

  [[nodiscard]] bool is_empty() const {
    return points.empty() && point_files.empty() && lines.empty() && line_files.empty();
  }
};
void add_interest(CLI::App* command, Interest& interest);

/// The same, read: CRS coordinates.
struct Places {
  std::vector<Position> points;
  std::vector<std::vector<Position>> lines;
};
/// fails  invalid_argument, io: names option or file and line
[[nodiscard]] Places read_places(const Interest& interest);

/// --tolerance-raster. Failures name the file.
[[nodiscard]] std::shared_ptr<const ToleranceField> tolerance_of_raster(const std::string& file,
                                                                        const Description& description,
                                                                        GridRect region);

}  // namespace talus::app
