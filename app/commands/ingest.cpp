#include "talus/ingest.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/options/arguments.hpp"
#include "app/options/input_options.hpp"
#include "app/terminal/fields.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::vector<std::string> files;  // the database last
  std::string void_weight = "1", memory = "1GiB", progress = "auto", priority = "later", grid_of, cell, height_step,
              tolerance, metric = "vertical";
  InputWords inputs_read;
  IngestOptions options;
  bool update = false, dry_run = false, json = false;

  [[nodiscard]] const std::string& database() const { return files.back(); }
  [[nodiscard]] std::vector<std::filesystem::path> inputs() const { return {files.begin(), files.end() - 1}; }
};

void settle_options(Request& request) {
  IngestOptions& o = request.options;
  o.inputs = request.inputs_read.read();
  o.void_weight = parse_weight(request.void_weight);
  o.error_metric = parse_error_metric(request.metric);
  if (!request.tolerance.empty()) o.finest_tolerance = parse_tolerance(request.tolerance);
  o.memory_bytes = parse_bytes(request.memory);
  if (!request.cell.empty()) {
    const auto [dx, dy] = parse_cell(request.cell);
    o.inputs.target_dx = dx;
    o.inputs.target_dy = dy;
  }
  if (!request.height_step.empty()) o.inputs.height_step = parse_height_step(request.height_step);
  o.inputs.priority_resolution = parse_priority(request.priority);
  if (!request.grid_of.empty()) {
    o.inputs.grid = grid_of(open_database(request.grid_of).snapshot().description());
    o.inputs.grid->step.reset();  // its grid, not its heights
  }
  if (request.update && o.error_metric != ErrorMetric::vertical)
    throw Failure(Cause::invalid_argument, "--metric is chosen when a database is made; it does not go with --update");
  if (request.update && o.finest_tolerance.value > 0)
    throw Failure(Cause::invalid_argument,
                  "--tolerance is chosen when a database is made; it does not go with --update");
}

IngestReport ingest_with_progress(Request& request) {
  Progress progress(parse_telling(request.progress));
  request.options.progress = [&](const IngestProgress& now) {
    if (interrupted()) throw Interrupted{};
    progress.show(now);
  };
  note_interrupts();
  if (request.update) require_database(request.database());
  if (request.update) return update(request.inputs(), request.database(), request.options);
  const std::filesystem::path part = unfinished_file(request.database());
  const std::string left =
      fmt::format("what is done is in {}, here or moved elsewhere --resume goes on with it", part.string());
  try {
    return ingest(request.inputs(), request.database(), request.options);
  } catch (const Interrupted&) {
    if (std::filesystem::exists(part)) throw Interrupted{"interrupted; " + left};
    throw;
  } catch (const Failure& failure) {
    if (failure.cause() == Cause::full && std::filesystem::exists(part)) note("no space is left; " + left);
    throw;
  }
}

void add_change(Json& json, const Description& d, const UpdateChange& change) {
  const bool has_heights = change.samples > change.filled;
  json["changed_samples"] = change.samples;
  json["filled_samples"] = change.filled;
  json["largest_difference"] = change.largest_m;
  json["largest_at"] = has_heights ? Json{change.x, change.y} : Json();
  json["changed_region"] = change.samples > 0 ? bounds(d, change.region) : Json();
}

void add_change(Table& table, const Description& d, const UpdateChange& change) {
  if (change.samples == 0) {
    table.add("changes", "nothing: the database holds all these samples already");
    return;
  }
  std::string samples = fmt::format("{} samples", counted(change.samples));
  if (change.filled > 0) samples += fmt::format(", {} of them void or outside before", counted(change.filled));
  table.add("changes", samples);
  if (change.samples > change.filled)
    table.add("", fmt::format("at most by {} m, at {}, {}", rounded(change.largest_m), change.x, change.y));
  table.add("", fmt::format("within {}", bounds_text(d, change.region)));
}

Exit dry_run(const Request& request) {
  IngestEstimate e = request.update ? estimate_update(request.inputs(), request.database(), request.options)
                                    : estimate_ingest(request.inputs(), request.database(), request.options);
  e.notes = with_options(std::move(e.notes));
  const Description& d = e.description;
  notes(e.notes);
  if (request.json) {
    Json json{{"database", request.database()}, {"source", d.source_name},
              {"type", d.source_type},          {"cols", d.extent.cols()},
              {"rows", d.extent.rows()},        {"tiles", e.tiles},
              {"threads", e.threads},           {"estimated_bytes", e.bytes},
              {"estimated_seconds", e.seconds}, {"notes", e.notes}};
    if (e.change) add_change(json, d, *e.change);
    print(json);
    return Exit::done;
  }
  Table table;
  table.add(request.update ? "would update" : "would make", request.database());
  if (e.change) add_change(table, d, *e.change);
  table.add("samples", fmt::format("{} x {} of {}, {} tiles to settle", d.extent.cols(), d.extent.rows(), d.source_type,
                                   counted(e.tiles)));
  table.add("file size", fmt::format("about {}", file_size(e.bytes, d.extent)));
  table.add("time", fmt::format("about {} with {} thread{}", timed(e.seconds), e.threads, e.threads == 1 ? "" : "s"));
  print(table);
  return Exit::done;
}

Exit run(Request& request) {
  settle_options(request);
  if (request.dry_run) return dry_run(request);
  IngestReport report = ingest_with_progress(request);
  report.notes = with_options(std::move(report.notes));
  const Description& d = report.description;
  if (d.extent.cols() == 1 || d.extent.rows() == 1)
    report.notes.push_back("the raster is one sample wide or high: no answer will hold a triangle");
  notes(report.notes);
  if (request.json) {
    Json json{
        {"database", request.database()}, {"source", d.source_name},        {"type", d.source_type},
        {"cols", d.extent.cols()},        {"rows", d.extent.rows()},        {"minimum", d.minimum},
        {"maximum", d.maximum},           {"void_samples", d.void_samples}, {"tiles", report.tiles},
        {"samples_now", report.samples},  {"pages", report.pages},          {"pages_read_back", report.pages_read_back},
        {"bytes", report.bytes},          {"seconds", report.seconds},      {"notes", report.notes}};
    if (report.change) add_change(json, d, *report.change);
    print(json);
    return Exit::done;
  }
  Table table;
  const bool is_untouched = report.change && report.change->samples == 0 && report.tiles == 0;
  table.add("database", is_untouched ? fmt::format("{}, as it was", request.database())
                                     : fmt::format("{}, {} pages", request.database(), counted(report.pages)));
  table.add("file size", file_size(report.bytes, d.extent));
  table.add("samples", fmt::format("{} x {} of {}, {} void", d.extent.cols(), d.extent.rows(), d.source_type,
                                   counted(d.void_samples)));
  table.add("heights", fmt::format("{} to {} {}", rounded(d.minimum), rounded(d.maximum), d.vertical_unit));
  if (report.change) add_change(table, d, *report.change);
  if (request.update) table.add("tiles", fmt::format("{} settled anew", counted(report.tiles)));
  std::string time = timed(report.seconds);
  if (report.samples > 0) {
    const double rate = static_cast<double>(report.samples) / 1e6 / std::max(report.seconds, 1e-9);
    time += fmt::format(", {:.3g} million samples a second", rate);
  }
  table.add("time", time);
  print(table);
  return Exit::done;
}

void add_grid_options(CLI::App& command, Request& request) {
  add_input_options(command, request.inputs_read);
  InputOptions& inputs = request.inputs_read.options;
  const std::string group = "Inputs";
  command.add_option("--priority", request.priority, "Where inputs overlap: the later one wins, or the finer")
      ->option_text("later|resolution")
      ->group(group);
  command.add_option("--t-srs", inputs.target_srs, "Resample to this CRS")->option_text("CRS")->group(group);
  command.add_option("--tr", request.cell, "Resample to cells of this size")->option_text("DX,DY")->group(group);
  command.add_option("--resampling", inputs.resampling, "How: near, bilinear, cubic, average")
      ->option_text("METHOD [bilinear]")
      ->group(group);
  command.add_option("--grid-of", request.grid_of, "Resample to the grid of this database")
      ->option_text("DATABASE")
      ->group(group);
  command
      .add_option("--height-step", request.height_step,
                  "Round heights to multiples of so many metres; half of it is part of every bound")
      ->option_text("METRES")
      ->group(group);
}

}  // namespace

void add_ingest(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("ingest", "Make a database from elevation rasters, or put more into one");
  command->add_option("FILES", request->files, "Raster files, folders of them or @LIST.txt; the database last")
      ->required()
      ->expected(2, 1 << 20)
      ->option_text("INPUT... DATABASE")
      ->check(is_named);
  command->add_flag("--overwrite", request->options.overwrite, "Replace the database if it exists");
  command->add_flag(
      "--resume", request->options.resume,
      "Go on with an ingest that was interrupted; what it left is checked first.\nAn interrupted update begins anew");
  command->add_flag("--update", request->update,
                    "Put the inputs into a database that exists, over what it holds; say what changed");
  command->add_flag("--dry-run", request->dry_run,
                    "Say what would be done, how large and how long, with --update what\nwould change; write nothing");
  command->add_option("--memory", request->memory, "Stay below this, whatever the size of the raster")
      ->option_text("BYTES [1GiB]");
  command->add_option("--threads", request->options.threads, "Changes nothing but the time; 0: one a core")
      ->transform(whole())
      ->option_text("N [0]");
  command
      ->add_option("--void-weight", request->void_weight,
                   "Metres of error per metre of ground where a triangle mixes data and void: a larger\n"
                   "weight draws the outline of the data more finely")
      ->option_text("W [1]");
  command
      ->add_option("--tolerance", request->tolerance,
                   "Keep only the vertices that an answer at M metres needs: a smaller file that answers no\n"
                   "finer and cannot be updated; without it every sample is kept, bit for bit")
      ->option_text("M");
  command
      ->add_option("--metric", request->metric,
                   "Distances along the vertical, or at right angles to triangles, which are less on slopes")
      ->option_text("vertical|perpendicular [vertical]");
  command->add_option("--progress", request->progress, "On a terminal, as JSON lines on standard error, or not")
      ->option_text("auto|json|none");
  command->add_flag("--json", request->json, "Print one JSON object");
  add_grid_options(*command, *request);
  command->footer(
      "\n"
      "Reads one band of local rasters (GeoTIFF, VRT, SRTM .hgt, ASCII grid and others GDAL reads),\n"
      "computes the error of every vertex and writes one file, in memory that does not grow with the\n"
      "raster. Samples are pixel centres; nodata, masks, alpha and NaN are voids; scale, offset and unit are applied.\n"
      "Colours are refused unless --decode says how they stand for heights.\n"
      "Tiles on one grid are joined; others are refused unless an option says how to resample them.\n"
      "Interrupted, killed or out of disk, it leaves DATABASE.part, and --resume goes on. An input that changes\n"
      "meanwhile, or a file that it names, is a failure.\n"
      "\nExamples:\n"
      "  talus ingest alps.tif alps.talus\n"
      "  talus ingest tiles/ country.talus --memory 512MiB\n"
      "  talus ingest --update new_tile.tif country.talus");
  command->callback([request, &action] { action = [request] { return run(*request); }; });
}

}  // namespace talus::app
