#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/options/arguments.hpp"
#include "app/options/outputs.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/report.hpp"
#include "query/export/output_file.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database, line, tolerance, output;
  bool json = false;
};

std::string csv(const Profile& profile) {
  fmt::memory_buffer lines;
  fmt::format_to(std::back_inserter(lines), "part,distance,x,y,height\n");
  for (std::size_t part = 0; part < profile.parts.size(); ++part) {
    for (const ProfileVertex& v : profile.parts[part]) {
      fmt::format_to(std::back_inserter(lines), "{},{},{},{},{}\n", part + 1, v.distance_m, v.x, v.y, v.height);
    }
  }
  return fmt::to_string(lines);
}

Json parts_of(const Profile& profile) {
  Json parts = Json::array();
  for (const auto& part : profile.parts) {
    Json vertices = Json::array();
    for (const ProfileVertex& v : part) {
      vertices.push_back({{"distance", v.distance_m}, {"x", v.x}, {"y", v.y}, {"height", v.height}});
    }
    parts.push_back(std::move(vertices));
  }
  return parts;
}

void check_output(const Request& request) {
  if (request.output.empty()) return;
  if (!request.output.ends_with(".csv")) {
    throw Failure(Cause::invalid_argument, fmt::format("--output {}: a profile is written as .csv", request.output));
  }
  require_no_input(request.output, {request.database});
}

Exit run(const Request& request) {
  const Metres tolerance = parse_tolerance(request.tolerance);
  const std::vector<Position> line = parse_line(request.line);
  check_output(request);
  const Snapshot now = open_database(request.database).snapshot();
  const Description& description = now.description();
  const Profile profile = now.profile(line, tolerance);
  if (!request.output.empty()) {
    const HoldInterrupts whole_file_or_none;
    OutputFile file(request.output);
    file.write(csv(profile));
    file.commit();
  }
  std::size_t vertices = 0;
  for (const auto& part : profile.parts) vertices += part.size();
  if (request.json) {
    Json object{{"length", profile.length_m},
                {"tolerance", profile.tolerance.value},
                {"bound", profile.bound.value},
                {"error_metric", name_of(description.error_metric)},
                {"vertices", vertices},
                {"parts", parts_of(profile)},
                {"pages_read", profile.cost.pages_read},
                {"bytes_read", profile.cost.bytes_read},
                {"seconds", profile.cost.seconds}};
    if (!request.output.empty()) object["output"] = request.output;
    print(object);
  } else if (request.output.empty()) {
    print(csv(profile));
  } else {
    Table table;
    table.add("length", fmt::format("{:.7g} m", profile.length_m));
    table.add("tolerance", metres(profile.tolerance.value));
    table.add("bound", bound_text(description, profile.bound));
    table.add("profile", fmt::format("{} vertices in {} parts", counted(vertices), counted(profile.parts.size())));
    table.add("read", fmt::format("{} pages, the header's among them, {}", counted(profile.cost.pages_read),
                                  sized(profile.cost.bytes_read)));
    table.add("time", timed(profile.cost.seconds));
    table.add("output", request.output);
    print(table);
  }
  return Exit::done;
}

}  // namespace

void add_profile(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("profile", "Heights along a line");
  command->add_option("DATABASE", request->database, "Database file")->required()->check(is_named);
  command->add_option("--line", request->line, "Points of the line, two or more")
      ->option_text("X,Y,X,Y,... REQUIRED")
      ->required();
  command->add_option("--tolerance", request->tolerance, "Metres, 0 or more, or inf")
      ->option_text("M REQUIRED")
      ->required();
  command->add_option("-o,--output", request->output, "Write the vertices to a .csv; an existing file is replaced")
      ->option_text("OUT")
      ->check(is_named);
  command->add_flag("--json", request->json, "Print one JSON object");
  command->footer(
      "\n"
      "Print the heights along a line, with few vertices: every covered sample on the line is within the tolerance.\n"
      "The line is straight between its points, which are in the database's CRS, X before Y. Between longitudes it\n"
      "goes the short way, across the antimeridian if need be.\n"
      "\n"
      "Each line of output has the number of the part, the distance along the line in metres on the ground, X, Y and\n"
      "the height in the source's vertical unit. A part ends where data does.\n"
      "\nExample:\n"
      "  talus profile alps.talus --line=7.6,45.9,7.7,46.0,7.8,46.0 --tolerance 2 -o ridge.csv");
  command->callback([request, &action] { action = [request] { return run(*request); }; });
}

}  // namespace talus::app
