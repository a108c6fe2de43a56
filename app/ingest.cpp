#include "talus/ingest.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/interrupt.hpp"
#include "app/progress.hpp"
#include "app/report.hpp"
#include "ingest/source.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string input, database, void_weight = "1";
  bool overwrite = false, json = false;
};

IngestReport ingest_with_progress(const Request& request) {
  Progress progress;
  IngestOptions options;
  options.overwrite = request.overwrite;
  options.void_weight = parse_weight(request.void_weight);
  options.progress = [&](double fraction, const char* stage) {
    if (interrupted()) throw Interrupted{};
    progress.show(fraction, stage);
  };
  note_interrupts();
  return ingest(request.input, request.database, options);
}

Exit run(const Request& request) {
  const std::vector<std::string> notes = Source({request.input}, {}).notes();
  const IngestReport report = ingest_with_progress(request);
  const Description& d = report.description;
  const auto samples = static_cast<std::uint64_t>(d.extent.samples());
  if (request.json) {
    print(Json{{"database", request.database},
               {"source", d.source_name},
               {"type", d.source_type},
               {"cols", d.extent.cols()},
               {"rows", d.extent.rows()},
               {"minimum", d.minimum},
               {"maximum", d.maximum},
               {"void_samples", d.void_samples},
               {"pages", report.pages},
               {"bytes", report.bytes},
               {"seconds", report.seconds}});
    return Exit::done;
  }
  Table table;
  table.add("database", fmt::format("{}, {} pages", request.database, counted(report.pages)));
  table.add("file size", file_size(report.bytes, d.extent));
  for (const std::string& note : notes) table.add("note", note);
  table.add("samples", fmt::format("{} x {} of {}, {} void", d.extent.cols(), d.extent.rows(), d.source_type,
                                   counted(d.void_samples)));
  table.add("heights", fmt::format("{} to {} {}", rounded(d.minimum), rounded(d.maximum), d.vertical_unit));
  table.add("time", fmt::format("{}, {:.3g} million samples a second", timed(report.seconds),
                                static_cast<double>(samples) / 1e6 / std::max(report.seconds, 1e-9)));
  if (d.extent.cols() == 1 || d.extent.rows() == 1) {
    table.add("note", "the raster is one sample wide or high: no answer will hold a triangle");
  }
  print(table);
  return Exit::done;
}

}  // namespace

void add_ingest(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("ingest", "Make a database from an elevation raster");
  command->add_option("INPUT", request->input, "Raster file")->required()->check(is_named);
  command->add_option("DATABASE", request->database, "Database file to make")->required()->check(is_named);
  command->add_flag("--overwrite", request->overwrite, "Replace the database if it exists");
  command
      ->add_option("--void-weight", request->void_weight,
                   "Metres of error per metre of ground where a triangle mixes data and void: a larger\n"
                   "weight draws the outline of the data more finely")
      ->option_text("W [1]");
  command->add_flag("--json", request->json, "Print one JSON object");
  command->footer(
      "\n"
      "Takes the first band of a local raster file (GeoTIFF, VRT, SRTM .hgt, ASCII grid and others GDAL\n"
      "reads), computes the exact error of every vertex and writes one file. Samples are pixel centres;\n"
      "nodata, masks and NaN are voids; the band's scale, offset and unit are applied.\n"
      "\nExample:\n  talus ingest alps.tif alps.talus");
  command->callback([request, &action] { action = [request] { return run(*request); }; });
}

}  // namespace talus::app
