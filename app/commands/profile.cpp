#include <algorithm>
#include <iterator>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/options/outputs.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database, output;
  std::vector<Position> line;
  Metres tolerance;
  bool json = false;
};

std::string csv(const Profile& profile) {
  fmt::memory_buffer lines;
  fmt::format_to(std::back_inserter(lines), "part,distance,x,y,height\n");
  for (std::size_t part = 0; part < profile.parts.size(); ++part) {
    for (const ProfileVertex& v : profile.parts[part]) {
      fmt::format_to(std::back_inserter(lines), "{},{},{},{},{}\n", part + 1, v.distance.value, v.x, v.y, v.height);
    }
  }
  return fmt::to_string(lines);
}

Json parts_of(const Profile& profile) {
  Json parts = Json::array();
  for (const auto& part : profile.parts) {
    Json vertices = Json::array();
    for (const ProfileVertex& v : part) {
      vertices.push_back({{"distance", v.distance.value}, {"x", v.x}, {"y", v.y}, {"height", v.height}});
    }
    parts.push_back(std::move(vertices));
  }
  return parts;
}

Exit run(Request& request) {
  if (!request.output.empty()) {
    require_ending(request.output, "a profile", {".csv"});
    require_no_input(request.output, {request.database});
  }
  const Snapshot now = open_database(request.database).snapshot();
  const Profile profile = now.profile(request.line, request.tolerance);
  if (std::any_of(request.line.begin(), request.line.end(), [&](Position p) { return !is_inside(now, p); }))
    note("the line leaves the raster; the profile has the parts inside");
  if (!request.output.empty()) write_text(request.output, csv(profile));
  std::size_t vertices = 0;
  for (const auto& part : profile.parts) vertices += part.size();
  if (request.json) {
    Json object{{"length", profile.length.value}};
    add_bound(object, now.description(), profile.tolerance, profile.bound);
    object.update({{"vertices", vertices}, {"parts", parts_of(profile)}});
    add_cost(object, profile.cost, profile.cost.seconds);
    if (!request.output.empty()) object["output"] = request.output;
    print(object);
  } else if (request.output.empty()) {
    print(csv(profile));
  } else {
    Table table;
    table.add("length", fmt::format("{:.7g} m", profile.length.value));
    add_bound(table, now.description(), profile.tolerance, profile.bound);
    table.add("profile", fmt::format("{} vertices in {} parts", counted(vertices), counted(profile.parts.size())));
    add_cost(table, profile.cost, profile.cost.seconds);
    table.add("output", request.output);
    print(table);
  }
  return Exit::done;
}

}  // namespace

void add_profile(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  Command command(program, "profile", "Print the heights along a line");
  command.database(request->database);
  command.group("Most used");
  command.option("--line", request->line, kLine, "X,Y,X,Y,...", "The line: two points or more")->required();
  command.option("--tolerance", request->tolerance, kTolerance, "M", "Tolerance in metres, 0 or more, or inf")
      ->required();
  command.file("-o,--output", request->output, "FILE.csv", "Write the vertices to this file. Default: to the screen");
  command.finish(
      action, request, run,
      "The profile has few vertices. Every sample on the line that has data lies within the tolerance of it. The line "
      "is straight between its points. talus help places explains X and Y.\n"
      "\n"
      "Each row has the number of the part, the distance along the line in metres on the ground, X, Y and the height "
      "in the vertical unit of the source. A part ends where the data end.\n"
      "\nExample:\n"
      "  talus profile alps.talus --line=7.6,45.9,7.7,46.0,7.8,46.0 --tolerance 2 -o ridge.csv");
}

}  // namespace talus::app
