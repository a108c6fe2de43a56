#include "app/options/places.hpp"

#include <cstddef>
#include <optional>

#include <fmt/format.h>

#include "app/options/arguments.hpp"
#include "ingest/files/lines.hpp"
#include "ingest/mosaic/tolerance_raster.hpp"
#include "talus/failure.hpp"

namespace talus::app {
namespace {

struct Part {
  std::uint64_t first_line = 0;  ///< of the file, from 1
  std::vector<Position> positions;
};

/// X and Y a line; blank lines part what lies between them.
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
    const std::optional<Position> position = parse_position(line);
    if (!position) {
      throw Failure(Cause::invalid_argument,
                    fmt::format("{}, line {}: X and Y are expected, two numbers; \"{}\" is not that", file, in.number(),
                                line.substr(0, 100)),
                    file);
    }
    if (++points > kMostPoints)
      throw Failure(Cause::invalid_argument, fmt::format("{} has more than {} points", file, kMostPoints), file);
    if (!is_begun) parts.push_back({in.number(), {}});
    is_begun = true;
    parts.back().positions.push_back(*position);
  }
  return parts;
}

void repeat(CLI::Option* option) {
  option->type_size(1)->expected(1)->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

}  // namespace

void add_interest(CLI::App* command, Interest& interest) {
  repeat(command
             ->add_option("--point", interest.points,
                          "The sample nearest to it is a vertex; may be repeated, as all of these")
             ->option_text("X,Y ..."));
  repeat(command->add_option("--points", interest.point_files, "The same for a file with X and Y a line")
             ->option_text("FILE ...")
             ->check(is_named));
  repeat(
      command->add_option("--line", interest.lines, "The samples nearest to a line are vertices, one a step along it")
          ->option_text("X,Y,X,Y,... ..."));
  repeat(command
             ->add_option("--lines", interest.line_files,
                          "The same for a file with X and Y a line, and a blank line between lines")
             ->option_text("FILE ...")
             ->check(is_named));
}

Places read_places(const Interest& interest) {
  Places places;
  for (const std::string& word : interest.points) {
    const std::optional<Position> point = parse_position(word);
    if (!point)
      throw Failure(Cause::invalid_argument, fmt::format("--point takes X,Y, two numbers; \"{}\" is not that", word));
    places.points.push_back(*point);
  }
  for (const std::string& file : interest.point_files) {
    for (const Part& part : read_parts(file))
      places.points.insert(places.points.end(), part.positions.begin(), part.positions.end());
  }
  for (const std::string& word : interest.lines) places.lines.push_back(parse_line(word));
  for (const std::string& file : interest.line_files) {
    for (Part& part : read_parts(file)) {
      if (part.positions.size() < 2) {
        throw Failure(
            Cause::invalid_argument,
            fmt::format("{}, line {}: a line of one point; expected two or more, and blank lines between lines only",
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
