#include "talus/accuracy.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/accuracy/accuracy_report.hpp"
#include "app/accuracy/timed_run.hpp"
#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/files/truth.hpp"
#include "app/options/arguments.hpp"
#include "app/options/input_options.hpp"
#include "app/options/outputs.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/say.hpp"
#include "query/export/output_file.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database;
  std::optional<std::string> bbox, tolerances, time, map;  // an empty word is none of them
  std::vector<std::string> against, outputs;
  InputWords inputs;
  std::optional<std::int32_t> window;
  int threads = 0;
  bool json = false;
};

bool is_page(const std::string& output) { return output.ends_with(".html") || output.ends_with(".htm"); }

/// What would fail after the work.
void check_output(const std::string& output, const Request& request) {
  if (!is_page(output) && !output.ends_with(".svg")) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--output {}: a report on accuracy is written as .html or .svg", output));
  }
  require_no_input(output, {request.database});
  require_no_input(output, request.against);
  const HoldInterrupts nothing_left_behind;
  const OutputFile can_be_written(output);
}

AccuracyOptions options_of(const Request& request) {
  AccuracyOptions options;
  options.window = request.window;
  options.threads = request.threads;
  options.maps = !request.outputs.empty();
  if (request.tolerances) options.tolerances = parse_tolerances(*request.tolerances);
  if (request.time) options.budget_seconds = parse_time(*request.time);
  if (request.map) {
    if (request.outputs.empty())
      throw Failure(Cause::invalid_argument, "--map needs --output: maps are part of a report");
    options.map_tolerance = parse_tolerances(*request.map, "--map").front();
  }
  return options;
}

/// Said on standard error, too: whoever reads a table of times may not compare two of its columns.
Exit say_beyond_bound(const Request& request, const AccuracyReport& report) {
  Exit code = Exit::done;
  for (const AccuracyPoint& point : report.points) {
    if (!is_beyond_bound(report, point)) continue;
    fmt::print(stderr,
               "talus: {}: BEYOND ITS BOUND: at {} m a sample lies {} m from the surface, the answer promises {} m; "
               "talus verify says what is wrong\n",
               request.database, point.tolerance.value, rounded(point.errors->largest.value),
               rounded(point.bound.value));
    code = Exit::differs;
  }
  return code;
}

Exit run(const Request& request) {
  // What is misspelt is said before a file is opened.
  AccuracyOptions options = options_of(request);
  std::optional<Rectangle> rectangle;
  bool is_clipped = false;
  if (request.bbox) rectangle = parse_bbox(*request.bbox);
  {
    // Closed again before anything is measured: what is open stays in memory.
    const Snapshot now = open_database(request.database).snapshot();
    if (rectangle) {
      const PlacedRectangle placed = now.region(*rectangle);
      options.region = placed.samples;
      is_clipped = placed.is_cut;
      if (is_clipped) note(clipped_text(*request.bbox));
    }
    if (!request.against.empty()) {
      options.truth =
          of_same_heights(open_truth(request.against, request.inputs.read(), now.description(), request.database),
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
  for (const std::string& output : request.outputs) {
    const std::string text = is_page(output) ? accuracy_html(report, names) : accuracy_svg(report, names);
    const HoldInterrupts whole_file_or_none;
    OutputFile file(output);
    file.write(text);
    file.commit();
  }
  notes(caveats(report, names));
  if (request.json) {
    Json object = accuracy_json(report, names);
    if (rectangle) {
      object["asked"] = Json::array({rectangle->xmin, rectangle->ymin, rectangle->xmax, rectangle->ymax});
      object["clipped"] = is_clipped;
    }
    if (!request.outputs.empty()) object["output"] = request.outputs;
    print(object);
    return say_beyond_bound(request, report);
  }
  std::string text = accuracy_text(report, names);
  for (const std::string& output : request.outputs) text += fmt::format("written: {}\n", output);
  print(text);
  return say_beyond_bound(request, report);
}

}  // namespace

void add_accuracy(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("accuracy", "What accuracy costs in time, bytes and vertices, measured");
  command->add_option("DATABASE", request->database, "Database file")->required()->check(is_named);
  command
      ->add_option("--against", request->against,
                   "What the database was made from, to measure errors against: rasters, folders, @LIST.txt.\n"
                   "Without it errors are against the database's own samples, if it keeps all of them")
      ->option_text("DEM ...")
      ->check(is_named);
  add_input_options(*command, request->inputs);
  command->add_option("--bbox", request->bbox, "Ask about this rectangle instead of the whole raster")
      ->option_text("XMIN,YMIN,XMAX,YMAX");
  command
      ->add_option("--window", request->window,
                   "Ask about windows of N x N samples, whatever the size of the raster or rectangle")
      ->transform(whole())
      ->check(CLI::Range(17, 4097))
      ->option_text("N");
  command
      ->add_option(
          "--tolerances", request->tolerances,
          "Metres, 0 or more and finite, with commas between; without them 1, 2, 5, 10 ... over the errors found")
      ->option_text("M,M,...");
  command
      ->add_option("--time", request->time,
                   "Recommend the least tolerance that so much time buys, as 10ms or 0.5s; without it the\n"
                   "tolerance amid the others is recommended, and what it takes")
      ->option_text("T");
  command->add_option("--map", request->map, "Tolerance of the maps; without it the recommended one")->option_text("M");
  command->add_option("--threads", request->threads, "Of an answer of a million samples or more; 0: one a core")
      ->transform(whole())
      ->check(CLI::Range(0, 1024))
      ->option_text("N [0]");
  command
      ->add_option("-o,--output", request->outputs,
                   "Write a report: .html (recommendation, curves, maps, table) or .svg (curves and maps). Repeat it\n"
                   "for both; an existing file is replaced")
      ->option_text("OUT ...")
      ->check(is_named)
      ->type_size(1)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_flag("--json", request->json, "Print one JSON object");
  command->footer(
      "\n"
      "Ask the same question at many tolerances, and print what each costs and gives: vertices, triangles, the size\n"
      "as a stream (.rqt, balanced), the time of an answer, and how far samples really are from its surface: the\n"
      "largest distance, what 95 % of them lie within, and the root mean square. Then say what a time buys, from an\n"
      "answer that was asked for at that very tolerance, with a talus query to get it.\n"
      "\n"
      "The question is the whole raster or the rectangle. A raster of more than 2049 x 2049 samples, or a rectangle "
      "of\n"
      "more than 4097 x 4097, is asked about through at most nine windows of 1025 x 1025, as a viewer asks, spread "
      "over\n"
      "those that are not flat; counts and times are then medians, errors are over all windows together.\n"
      "\n"
      "Warm: the file is in memory, nothing of it decoded. Cold: the system was asked to drop the file, and it was\n"
      "opened anew; opening comes on top. The report says whether the system obeyed. Other programs on the machine\n"
      "make times longer: measure on a quiet one.\n"
      "\nExample:\n"
      "  talus accuracy alps.talus\n"
      "  talus accuracy alps.talus --against alps.tif --time 10ms -o alps.html -o alps.svg\n"
      "  talus accuracy alps.talus --bbox=7.5,45.9,7.8,46.1 --tolerances 1,5,20 --json");
  command->callback([request, &action] { action = [request] { return run(*request); }; });
}

}  // namespace talus::app
