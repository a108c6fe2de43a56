#include "app/options/required_points.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/options/arguments.hpp"
#include "ingest/files/lines.hpp"
#include "ingest/mosaic/tolerance_raster.hpp"
#include "talus/failure.hpp"

namespace talus::app {
namespace {

struct Part {
  std::uint64_t first_line = 0;  ///< number of its first line in the file, from 1
  std::vector<Position> positions;
};

/// Reads X and Y from each line. Blank lines separate the parts.
std::vector<Part> read_parts(const std::string& file) {
  Lines in(file, "file of points", kLongestPointLine);
  std::vector<Part> parts;
  std::string line;
  bool is_begun = false;
  for (std::size_t points = 0; in.next(line);) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) {
      is_begun = false;
      continue;
    }
    const std::optional<Position> position = kPoint.read(line);
    if (!position) {
      throw Failure(
          Cause::invalid_argument,
          fmt::format("{}, line {}: expected {}, not \"{}\"", file, in.number(), kPoint.expected, line.substr(0, 100)),
          file);
    }
    if (++points > kMostPoints)
      throw Failure(Cause::invalid_argument, fmt::format("{} has more than {} points; split it", file, kMostPoints),
                    file);
    if (!is_begun) parts.push_back({in.number(), {}});
    is_begun = true;
    parts.back().positions.push_back(*position);
  }
  return parts;
}

}  // namespace

void add_places(Command& command, Places& places) {
  command.group("Samples that must be vertices");
  command.options("--point", places.points, kPoint, "X,Y", "The sample nearest to this point. Can be repeated");
  command.files("--points", places.point_files, "FILE", "The same for a file with X and Y on each line");
  command.options("--line", places.lines, kLine, "X,Y,X,Y,...",
                  "The samples nearest to this line. The edges of the mesh need not follow it. Can be repeated");
  command.files("--lines", places.line_files, "FILE",
                "The same for a file with X and Y on each line, and a blank line between two lines");
}

Places with_files_read(Places places) {
  for (const std::string& file : places.point_files) {
    for (const Part& part : read_parts(file))
      places.points.insert(places.points.end(), part.positions.begin(), part.positions.end());
  }
  for (const std::string& file : places.line_files) {
    for (Part& part : read_parts(file)) {
      if (part.positions.size() < 2) {
        throw Failure(Cause::invalid_argument,
                      fmt::format("{}, line {}: this line has one point; give it two or more, and put blank lines "
                                  "between lines only",
                                  file, part.first_line),
                      file);
      }
      places.lines.push_back(std::move(part.positions));
    }
  }
  return places;
}

std::shared_ptr<const ToleranceField> tolerance_of_raster(const std::string& file, const Description& description,
                                                          GridRect region) {
  const ToleranceRaster raster = blaming(file, [&] { return read_tolerances(file, description, region); });
  try {
    return raster_tolerance(description, region, raster.cells, raster.metres);
  } catch (const Failure& f) {
    throw Failure(f.cause(), fmt::format("--tolerance-raster {}: {}", file, f.what()), file);
  }
}

}  // namespace talus::app
