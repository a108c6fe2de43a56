#include "talus/ingest.hpp"

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/options/shared_options.hpp"
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
  std::string grid_of;
  std::optional<std::pair<double, double>> cell;
  IngestOptions options;
  Telling telling = Telling::people;
  bool update = false, dry_run = false, json = false;

  [[nodiscard]] const std::string& database() const { return files.back(); }
  [[nodiscard]] std::vector<std::filesystem::path> inputs() const { return {files.begin(), files.end() - 1}; }
};

void complete_options(Request& request) {
  const std::string ending = std::filesystem::path(request.database()).extension().string();
  for (const char* raster : {".tif", ".tiff", ".vrt", ".hgt", ".asc", ".img", ".bil", ".nc", ".png"}) {
    if (request.update || ending != raster) continue;
    throw Failure(Cause::invalid_argument,
                  fmt::format("the last name is the database, and {} ends like a raster; name a database such as "
                              "land.talus at the end",
                              request.database()));
  }
  IngestOptions& o = request.options;
  if (request.cell) std::tie(o.inputs.target_dx, o.inputs.target_dy) = *request.cell;
  if (!request.grid_of.empty()) {
    o.inputs.grid = grid_of(open_database(request.grid_of).snapshot().description());
    o.inputs.grid->step.reset();  // its grid, not its heights
  }
  const auto refuse_if = [](bool is_wrong, const char* sentence) {
    if (is_wrong) throw Failure(Cause::invalid_argument, sentence);
  };
  refuse_if(request.update && o.error_metric != ErrorMetric::vertical,
            "--metric is fixed when a database is made: remove it, or --update");
  refuse_if(request.update && o.finest_tolerance.value > 0,
            "--tolerance is fixed when a database is made: remove it, or --update");
}

IngestReport ingest_with_progress(Request& request) {
  Progress progress(request.telling);
  request.options.progress = [&](const IngestProgress& now) {
    if (interrupted()) throw Interrupted{};
    progress.show(now);
  };
  note_interrupts();
  if (request.update) require_database(request.database());
  if (request.update) return update(request.inputs(), request.database(), request.options);
  const std::filesystem::path part = unfinished_file(request.database());
  const std::string remedy =
      fmt::format("{} keeps what is done; run the same command with --resume to continue", part.string());
  try {
    return ingest(request.inputs(), request.database(), request.options);
  } catch (const Interrupted&) {
    if (std::filesystem::exists(part)) throw Interrupted{"interrupted; " + remedy};
    throw;
  } catch (const Failure& failure) {
    if (failure.cause() == Cause::full && std::filesystem::exists(part)) note(remedy);
    throw;
  }
}

void add_change(Json& json, const Description& d, const UpdateChange& change) {
  const bool has_heights = change.samples > change.filled;
  json["changed_samples"] = change.samples;
  json["filled_samples"] = change.filled;
  json["largest_difference"] = change.largest.value;
  json["largest_at"] = has_heights ? Json{change.x, change.y} : Json();
  json["changed_region"] = change.samples > 0 ? bounds(d, change.region) : Json();
}

void add_change(Table& table, const Description& d, const UpdateChange& change) {
  if (change.samples == 0) {
    table.add("changes", "nothing: the database has all these samples already");
    return;
  }
  std::string samples = fmt::format("{} samples", counted(change.samples));
  if (change.filled > 0) samples += fmt::format(", {} of them had no data before", counted(change.filled));
  table.add("changes", samples);
  if (change.samples > change.filled)
    table.add("", fmt::format("by up to {} m, at {}, {}", rounded(change.largest.value), change.x, change.y));
  table.add("", fmt::format("within {}", bounds_text(d, change.region)));
}

Json source_of(const Request& request, const Description& d) {
  return {{"database", request.database()},
          {"source", d.source_name},
          {"type", d.source_type},
          {"cols", d.extent.cols()},
          {"rows", d.extent.rows()}};
}

Exit dry_run(const Request& request) {
  IngestEstimate e = request.update ? estimate_update(request.inputs(), request.database(), request.options)
                                    : estimate_ingest(request.inputs(), request.database(), request.options);
  e.notes = with_options(std::move(e.notes));
  const Description& d = e.description;
  notes(e.notes);
  if (request.json) {
    Json json = source_of(request, d);
    json.update({{"tiles", e.tiles}, {"threads", e.threads}, {"estimated_bytes", e.bytes}});
    json.update({{"estimated_seconds", e.seconds}, {"notes", e.notes}});
    if (e.change) add_change(json, d, *e.change);
    print(json);
    return Exit::done;
  }
  Table table;
  table.add(request.update ? "would update" : "would make", request.database());
  if (e.change) add_change(table, d, *e.change);
  table.add("samples", fmt::format("{} x {} of {}, {} tiles to compute", d.extent.cols(), d.extent.rows(),
                                   d.source_type, counted(e.tiles)));
  table.add("file size", fmt::format("about {}", file_size(e.bytes, d.extent)));
  table.add("time", fmt::format("about {} with {} thread{}", timed(e.seconds), e.threads, e.threads == 1 ? "" : "s"));
  print(table);
  return Exit::done;
}

Exit run(Request& request) {
  complete_options(request);
  if (request.dry_run) return dry_run(request);
  IngestReport report = ingest_with_progress(request);
  report.notes = with_options(std::move(report.notes));
  const Description& d = report.description;
  if (d.extent.cols() == 1 || d.extent.rows() == 1)
    report.notes.push_back("the raster is one sample wide or high: no answer has a triangle");
  notes(report.notes);
  if (request.json) {
    Json json = source_of(request, d);
    json.update({{"minimum", d.minimum_height}, {"maximum", d.maximum_height}, {"void_samples", d.void_samples}});
    json.update({{"tiles", report.tiles}, {"samples_now", report.samples}, {"pages", report.pages}});
    json.update({{"pages_read_back", report.pages_read_back}, {"bytes", report.bytes}});
    json.update({{"seconds", report.seconds}, {"notes", report.notes}});
    if (report.change) add_change(json, d, *report.change);
    print(json);
    return Exit::done;
  }
  Table table;
  const bool is_untouched = report.change && report.change->samples == 0 && report.tiles == 0;
  table.add("database", is_untouched ? fmt::format("{}, unchanged", request.database())
                                     : fmt::format("{}, {} pages", request.database(), counted(report.pages)));
  table.add("file size", file_size(report.bytes, d.extent));
  table.add("samples", fmt::format("{} x {} of {}, {} void", d.extent.cols(), d.extent.rows(), d.source_type,
                                   counted(d.void_samples)));
  table.add("heights",
            fmt::format("{} to {} {}", rounded(d.minimum_height), rounded(d.maximum_height), d.vertical_unit));
  if (report.change) add_change(table, d, *report.change);
  if (request.update) table.add("tiles", fmt::format("{} computed again", counted(report.tiles)));
  std::string time = timed(report.seconds);
  if (report.samples > 0) {
    const double rate = static_cast<double>(report.samples) / 1e6 / std::max(report.seconds, 1e-9);
    time += fmt::format(", {:.3g} million samples/s", rate);
  }
  table.add("time", time);
  print(table);
  return Exit::done;
}

void add_grid_options(Command& command, Request& request) {
  InputOptions& inputs = request.options.inputs;
  command.group("Joining and resampling");
  command.choice("--priority", inputs.priority_resolution, Names<bool>{{"later", false}, {"resolution", true}},
                 "Which input wins where several overlap.\n"
                 "later (default): the one that comes later on the command line\n"
                 "resolution: the one with smaller cells");
  command.option("--t-srs", inputs.target_srs, "CRS", "Resample to this CRS");
  command.option("--tr", request.cell, kCell, "DX,DY", "Resample to cells of this size, in units of the CRS");
  command.choice("--resampling", inputs.resampling,
                 Names<Resampling>{{"bilinear", Resampling::bilinear},
                                   {"near", Resampling::near},
                                   {"cubic", Resampling::cubic},
                                   {"average", Resampling::average}},
                 "Resample by bilinear (default), near, cubic or average");
  command.file("--grid-of", request.grid_of, "DATABASE", "Resample to the grid of this database");
  command.option("--height-step", inputs.height_step, kMetresAboveZero, "M",
                 "Round heights to multiples of M metres. Every bound then grows by M/2");
}

}  // namespace

void add_ingest(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  IngestOptions& options = request->options;
  Command command(program, "ingest", "Make a database from elevation rasters, or update one");
  command.group("Arguments")
      .file("INPUT... DATABASE", request->files, "INPUT... DATABASE",
            "Rasters, folders of them or @LIST.txt; the database last")
      ->required()
      ->expected(2, 1 << 20);

  command.group("Most used");
  command.flag("--update", request->update, "Write the inputs over what the database holds, and show what changed");
  command.flag("--overwrite", options.overwrite, "Replace the database if it exists");
  command.flag(
      "--dry-run", request->dry_run,
      "Write nothing. Show how large the database becomes and how long that takes; with --update, what changes");

  command.group("How to work");
  command.flag("--resume", options.resume, "Continue an ingest that was interrupted. An update starts again instead");
  command.option("--memory", options.memory_bytes, kBytes, "BYTES", "Use less memory than this. Default: 1GiB");
  command.threads(options.threads);
  command.choice("--progress", request->telling,
                 Names<Telling>{{"auto", Telling::people}, {"json", Telling::json}, {"none", Telling::nobody}},
                 "auto (default): a line on a terminal\n"
                 "json: lines of JSON on standard error\n"
                 "none: nothing");

  command.group("What the database promises");
  command.option(
      "--tolerance", options.finest_tolerance, kTolerance, "M",
      "Make a smaller database: it keeps only the vertices that answers at M metres need, gives no finer answer "
      "and cannot be updated. Default: keep every sample, bit for bit");
  command.option(
      "--void-weight", options.void_weight, kWeight, "W",
      "How closely a mesh follows the outline of voids: it is off by at most tolerance / W metres on the ground. "
      "Default: 1");
  command.choice("--metric", options.error_metric,
                 Names<ErrorMetric>{{"vertical", ErrorMetric::vertical}, {"perpendicular", ErrorMetric::perpendicular}},
                 "vertical (default): distances along the vertical\n"
                 "perpendicular: at right angles to the triangles, shorter on slopes");

  add_input_options(command, options.inputs);
  add_grid_options(command, *request);
  command.finish(
      action, request, run,
      "Reads one band of local rasters: GeoTIFF, VRT, SRTM .hgt, ASCII grid and others that GDAL reads. Scale, offset "
      "and unit are applied. Samples are pixel centres. talus help voids explains samples without data.\n"
      "\n"
      "Rasters on one grid are joined. Others need an option that says how to resample them.\n"
      "\n"
      "An interrupted ingest leaves DATABASE.part; run the same command with --resume to continue. An input must not "
      "change meanwhile.\n"
      "\nExamples:\n"
      "  talus ingest alps.tif alps.talus\n"
      "  talus ingest tiles/ country.talus --memory 512MiB\n"
      "  talus ingest --update new_tile.tif country.talus");
}

}  // namespace talus::app
