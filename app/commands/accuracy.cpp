#include "talus/accuracy.hpp"

#include <cmath>
#include <string_view>

#include "app/accuracy/accuracy_report.hpp"
#include "app/accuracy/timed_run.hpp"
#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/files/truth.hpp"
#include "app/options/outputs.hpp"
#include "app/options/shared_options.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/say.hpp"
#include "query/export/output_file.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database;
  std::optional<Rectangle> bbox;
  std::vector<std::string> against, outputs;
  InputOptions inputs;
  AccuracyOptions options;
  bool json = false;
};

const Kind<Metres> kMapTolerance{"metres, 0 or more", [](std::string_view word) {
                                   const std::optional<Metres> metres = kTolerance.read(word);
                                   return metres && std::isfinite(metres->value) ? metres : std::nullopt;
                                 }};

bool is_page(const std::string& output) { return output.ends_with(".html") || output.ends_with(".htm"); }

/// Refuses before the work what would fail after it.
void check_output(const std::string& output, const Request& request) {
  require_ending(output, "a report", {".html", ".htm", ".svg"});
  require_no_input(output, {request.database});
  require_no_input(output, request.against);
  const HoldInterrupts nothing_left_behind;
  const OutputFile can_be_written(output);
}

/// A reader of the times may not compare the columns: standard error says it too.
Exit say_beyond_bound(const Request& request, const AccuracyReport& report) {
  Exit code = Exit::done;
  for (const AccuracyPoint& point : report.points) {
    if (!is_beyond_bound(report, point)) continue;
    say(fmt::format(
        "{}: BEYOND ITS BOUND: at {} m a sample lies {} m from the surface, and the bound is {} m; talus "
        "verify says what is wrong",
        request.database, point.tolerance.value, rounded(point.errors->largest.value), rounded(point.bound.value)));
    code = Exit::differs;
  }
  return code;
}

Exit run(Request& request) {
  AccuracyOptions& options = request.options;
  options.maps = !request.outputs.empty();
  if (options.map_tolerance && !options.maps)
    throw Failure(Cause::invalid_argument, "--map needs --output: a map is part of a report");
  bool is_clipped = false;
  {
    // Closed again before anything is measured: what is open stays in memory.
    const Snapshot now = open_database(request.database).snapshot();
    if (request.bbox) {
      const PlacedRectangle placed = now.region(*request.bbox);
      options.region = placed.samples;
      is_clipped = placed.is_cut;
      if (is_clipped) note(clipped_text(*request.bbox));
    }
    if (!request.against.empty()) {
      options.truth = of_same_heights(open_truth(request.against, request.inputs, now.description(), request.database),
                                      request.against, request.database);
    }
  }
  for (const std::string& output : request.outputs) check_output(output, request);

  std::optional<Progress> progress(std::in_place);
  options.progress = [&](double fraction, const char* stage) { progress->show(fraction, stage); };
  const AccuracyReport report = measure_accuracy(request.database, options);
  progress.reset();  // ends its line

  AccuracyNames names{request.database, request.against.empty() ? "" : name_of(request.against)};
  if (const auto query = advised_query(report, names); !query.empty()) names.followed_seconds = seconds_of(query);
  for (const std::string& output : request.outputs)
    write_text(output, is_page(output) ? accuracy_html(report, names) : accuracy_svg(report, names));
  notes(caveats(report, names));
  if (request.json) {
    Json object = accuracy_json(report, names);
    if (request.bbox) add_rectangle(object, *request.bbox, is_clipped);
    if (!request.outputs.empty()) object["output"] = request.outputs;
    print(object);
    return say_beyond_bound(request, report);
  }
  std::string text = accuracy_text(report, names);
  for (const std::string& output : request.outputs) text += fmt::format("output: {}\n", output);
  print(text);
  return say_beyond_bound(request, report);
}

}  // namespace

void add_accuracy(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  AccuracyOptions& options = request->options;
  Command command(program, "accuracy", "Measure what a tolerance costs and gives");
  command.database(request->database);
  command.group("Most used");
  command.option("--tolerances", options.tolerances, kTolerances, "M,M,...",
                 "Tolerances to measure, in metres. Default: 1, 2, 5, 10 ... over the errors in the database");
  command.option("--time", options.limit_seconds, kSeconds, "T",
                 "Recommend the smallest tolerance that answers within this time, such as 10ms or 0.5s. Default: "
                 "recommend a tolerance in the middle");
  command.files("-o,--output", request->outputs, "OUT",
                "Write a report: .html (recommendation, curves, maps, table) or .svg (curves, maps). Can be repeated");
  command.group("What to measure");
  command.bbox(request->bbox, "Measure this rectangle. Default: the whole raster");
  command.number("--window", options.window, "N", "Measure windows of N x N samples", 17, 4097);
  command.option("--map", options.map_tolerance, kMapTolerance, "M",
                 "Tolerance of the maps in the report. Default: the recommended one");
  command.file(
      "--against", request->against, "DEM...",
      "Measure errors against these rasters, folders or @LIST.txt, from which the database was made. Default: its "
      "own samples, if it keeps all of them");
  add_input_options(command, request->inputs);
  command.group("Other").threads(options.threads);
  command.finish(
      action, request, run,
      "Asks the same question at many tolerances. For each it prints the vertices, the triangles, the size as an .rqt "
      "file, the time, and how far the samples lie from the surface: the largest distance, the distance that 95 % of "
      "them keep, and the root mean square. Then it recommends a tolerance.\n"
      "\n"
      "A raster of more than 2049 x 2049 samples, or a rectangle of more than 4097 x 4097, is measured in at most nine "
      "windows of 1025 x 1025 that are not flat. Counts and times are then medians; errors are over all windows.\n"
      "\n"
      "Warm: the file is in memory, but not decoded. Cold: the system was asked to drop the file from memory. The "
      "report says whether it did. Measure on a machine that does nothing else.\n"
      "\nExamples:\n"
      "  talus accuracy alps.talus\n"
      "  talus accuracy alps.talus --against alps.tif --time 10ms -o alps.html -o alps.svg\n"
      "  talus accuracy alps.talus --bbox=7.5,45.9,7.8,46.1 --tolerances 1,5,20 --json");
}

}  // namespace talus::app
