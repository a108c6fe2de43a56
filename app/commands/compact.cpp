#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/options/arguments.hpp"
#include "app/terminal/report.hpp"
#include "talus/ingest.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database;
  bool json = false;
};

Exit run(const Request& request) {
  const CompactReport report = compact(request.database);
  if (request.json) {
    print(Json{{"database", request.database},
               {"bytes_before", report.bytes_before},
               {"bytes", report.bytes},
               {"seconds", report.seconds}});
    return Exit::done;
  }
  const std::uint64_t gained = report.bytes_before - report.bytes;
  Table table;
  table.add("database", gained > 0 ? request.database : request.database + ", as it was: there is nothing to gain");
  table.add("file size", sized(report.bytes));
  if (gained > 0) {
    const double share = 100.0 * static_cast<double>(gained) / static_cast<double>(report.bytes_before);
    table.add("gained", fmt::format("{}, {:.1f} % of {}", sized(gained), share, sized(report.bytes_before)));
  }
  table.add("time", timed(report.seconds));
  print(table);
  return Exit::done;
}

}  // namespace

void add_compact(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("compact", "Make a database's file as small as it can be");
  command->add_option("DATABASE", request->database, "Database file")->required()->check(is_named);
  command->add_flag("--json", request->json, "Print one JSON object");
  command->footer(
      "\n"
      "Updates leave room in the file that later updates use. This command writes the file without it.\n"
      "Answers stay the same. Programs that have the database open keep the old file.\n"
      "\nExample:\n  talus compact country.talus");
  command->callback([request, &action] { action = [request] { return run(*request); }; });
}

}  // namespace talus::app
