#pragma once
// Options for points, lines and tolerances that a raster gives.

#include <memory>
#include <string>
#include <vector>

#include "app/options/command.hpp"
#include "talus/question.hpp"

namespace talus::app {

/// Points and lines in CRS coordinates, and files with more of them.
struct Places {
  std::vector<Position> points;
  std::vector<std::vector<Position>> lines;
  std::vector<std::string> point_files, line_files;

  [[nodiscard]] bool is_empty() const {
    return points.empty() && lines.empty() && point_files.empty() && line_files.empty();
  }
};
void add_places(Command& command, Places& places);
/// Adds what the files hold.
/// fails  invalid_argument, io: names file and line
[[nodiscard]] Places with_files_read(Places places);

/// The tolerances of --tolerance-raster. Failures name the file.
[[nodiscard]] std::shared_ptr<const ToleranceField> tolerance_of_raster(const std::string& file,
                                                                        const Description& description,
                                                                        GridRect region);

}  // namespace talus::app
