#include "app/commands/commands.hpp"
#include "app/terminal/report.hpp"
#include "talus/ingest.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database;
  bool json = false;
};

Exit run(Request& request) {
  const CompactReport report = compact(request.database);
  if (request.json) {
    print(Json{{"database", request.database},
               {"bytes_before", report.bytes_before},
               {"bytes", report.bytes},
               {"seconds", report.seconds}});
    return Exit::done;
  }
  const std::uint64_t saved = report.bytes_before - report.bytes;
  Table table;
  table.add("database", saved > 0 ? request.database : request.database + ", unchanged: no space was unused");
  table.add("file size", sized(report.bytes));
  if (saved > 0) {
    const double share = 100.0 * static_cast<double>(saved) / static_cast<double>(report.bytes_before);
    table.add("saved", fmt::format("{}, {:.1f} % of {}", sized(saved), share, sized(report.bytes_before)));
  }
  table.add("time", timed(report.seconds));
  print(table);
  return Exit::done;
}

}  // namespace

void add_compact(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  Command command(program, "compact", "Make a database's file smaller after updates");
  command.database(request->database);
  command.finish(action, request, run,
                 "Updates leave unused space in the file. This command writes the file without it. Answers stay the "
                 "same. A program that has the database open goes on reading the old file.\n"
                 "\nExample:\n  talus compact country.talus");
}

}  // namespace talus::app
