#include <algorithm>
#include <cctype>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/files/truth.hpp"
#include "app/options/arguments.hpp"
#include "app/options/input_options.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/report.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database, tolerance;
  std::vector<std::string> against;
  InputWords inputs;
  bool json = false;
};

struct Checked {
  VerifyReport report;
  Description description;
  std::vector<std::string> sources;  ///< names of what the database was made from
};

std::vector<std::string> sources_of(const Snapshot& now) {
  std::vector<std::string> names;
  try {
    for (const SourceFile& source : now.provenance().sources) names.push_back(source.name);
  } catch (const Failure&) {
    // The check says that the provenance is damaged.
  }
  return names;
}

/// A file whose header or outer structure is damaged cannot be checked any further.
Snapshot open_or_advise(const std::string& database) {
  require_database(database);  // what is something else needs no backup
  try {
    return Database::open(database).snapshot();
  } catch (const Failure& f) {
    if (f.cause() != Cause::corrupt) throw;
    throw Failure(Cause::corrupt,
                  fmt::format("{}; restore the file from a backup, or ingest its sources again", f.what()), database);
  }
}

Checked check(const Request& request, std::optional<Metres> tolerance) {
  const Snapshot now = open_or_advise(request.database);
  Checked made{{}, now.description(), sources_of(now)};
  Progress progress;
  VerifyOptions options;
  options.tolerance = tolerance;
  options.progress = [&](double fraction, const char* stage) { progress.show(fraction, stage); };
  if (!request.against.empty())
    options.truth = open_truth(request.against, request.inputs.read(), made.description, request.database);
  made.report = verify(now, options);
  return made;
}

/// What to do with a damaged database, and what it is still good for.
std::string advice(const Checked& checked) {
  constexpr std::size_t kNamed = 3;
  std::string sources;
  for (std::size_t i = 0; i < std::min(kNamed, checked.sources.size()); ++i)
    sources += (i == 0 ? "" : ", ") + checked.sources[i];
  if (checked.sources.size() > kNamed) sources += fmt::format(" and {} more", checked.sources.size() - kNamed);
  const std::string again = sources.empty() ? "ingest its sources again" : "ingest again from: " + sources;
  const std::string restore = "restore the file from a backup, or " + again;
  if (!checked.report.is_rest_usable) return "do not use it; " + restore;
  return (checked.report.damaged.empty() ? "answers are right, but the file changed since it was made; "
                                         : "answers that need nothing from the damaged rectangles are right; ") +
         restore;
}

// The surface is double arithmetic on heights: a nanometre, and a part in 10¹², is rounding.
bool is_within(Metres error, Metres tolerance, double part) {
  return error.value <= tolerance.value * (1 + part) + 1e-9;
}

/// Whether the measured surface keeps what was promised.
bool is_within_bound(const Checked& checked, std::optional<Metres> tolerance) {
  const VerifyReport& report = checked.report;
  if (!tolerance || !report.true_error) return true;
  const Description& d = checked.description;
  const Metres promised{std::max({tolerance->value, d.lossy_metres, d.finest_tolerance})};
  // Cells of degrees are measured in two ways here and there: a millionth.
  return report.perpendicular_error ? is_within(*report.perpendicular_error, promised, 1e-6)
                                    : is_within(*report.true_error, promised, 1e-12);
}

Exit exit_of(const Checked& checked, std::optional<Metres> tolerance) {
  if (checked.report.is_damaged()) return Exit::corrupt;
  return checked.report.differences > 0 || !is_within_bound(checked, tolerance) ? Exit::differs : Exit::done;
}

std::string verdict(const Checked& checked, std::optional<Metres> tolerance, bool with_details) {
  if (checked.report.is_damaged()) return "DAMAGED";
  if (!is_within_bound(checked, tolerance)) return "BEYOND ITS BOUND";
  if (checked.report.differences > 0) return with_details ? "NOT THE SAME AS THE SOURCE (sound in itself)" : "DIFFERS";
  return "sound";
}

std::string lower(std::string words) {
  std::transform(words.begin(), words.end(), words.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return words;
}

Json to_json(const Checked& checked, std::optional<Metres> tolerance) {
  const VerifyReport& report = checked.report;
  Json damaged = Json::array();
  for (const DamagedPart& part : report.damaged) {
    const Rectangle& r = part.rectangle;
    const GridRect& g = part.samples;
    damaged.push_back({{"rectangle", {r.xmin, r.ymin, r.xmax, r.ymax}},
                       {"samples", {g.first.col, g.first.row, g.last.col, g.last.row}},
                       {"finding", part.finding},
                       {"findings", part.findings}});
  }
  Json json{{"verdict", lower(verdict(checked, tolerance, false))},
            {"pages", report.pages},
            {"records", report.records},
            {"answers", report.answers},
            {"samples", report.samples},
            {"findings", report.findings},
            {"finding_count", report.finding_count},
            {"differences", report.differences},
            {"damaged", damaged},
            {"rest_usable", report.is_rest_usable}};
  if (report.is_damaged()) json["advice"] = advice(checked);
  if (report.true_error) {
    json["true_error"] = report.true_error->value;
    if (report.perpendicular_error) json["perpendicular_error"] = report.perpendicular_error->value;
    if (tolerance) json["tolerance"] = tolerance->value;
    json["vertices"] = report.vertices;
    json["triangles"] = report.triangles;
    json["covered_samples"] = report.covered_samples;
    json["uncovered_samples"] = report.uncovered_samples;
    json["stray_samples"] = report.stray_samples;
  }
  return json;
}

Table to_table(const Request& request, const Checked& made, std::optional<Metres> tolerance) {
  const VerifyReport& report = made.report;
  Table table;
  std::string checked = fmt::format("{} pages, {} records, {} answers", counted(report.pages), counted(report.records),
                                    counted(report.answers));
  if (!request.against.empty()) {
    checked += fmt::format(", {} samples against {}", counted(report.samples), name_of(request.against));
  }
  table.add("checked", checked);
  if (report.true_error) {
    table.add("mesh", fmt::format("{} vertices, {} triangles", counted(report.vertices), counted(report.triangles)));
    table.add("tolerance", tolerance ? metres(tolerance->value) : "the finest of the database");
    if (const std::string why = tolerance ? why_coarser(made.description, *tolerance) : ""; !why.empty())
      table.add("", why);
    table.add("true error", fmt::format("{}, over all valid samples under the mesh", metres(report.true_error->value)));
    if (report.perpendicular_error)
      table.add("", fmt::format("{} at right angles to triangles, which is what the tolerance is about",
                                metres(report.perpendicular_error->value)));
    table.add("covered", fmt::format("{} samples", counted(report.covered_samples)));
    if (report.uncovered_samples > 0) {
      table.add("uncovered",
                fmt::format("{} covered samples lie under no triangle", counted(report.uncovered_samples)));
    }
    if (report.stray_samples > 0) {
      table.add("stray", fmt::format("{} valid samples, corners of no finest triangle of data, lie under no triangle",
                                     counted(report.stray_samples)));
    }
  }
  for (const std::string& finding : report.findings) table.add("finding", finding);
  if (report.finding_count > report.findings.size()) {
    table.add("", fmt::format("and {} more", counted(report.finding_count - report.findings.size())));
  }
  constexpr std::size_t kListed = 20;
  for (std::size_t i = 0; i < std::min(kListed, report.damaged.size()); ++i)
    table.add(i == 0 ? "damaged" : "", bounds_text(made.description, report.damaged[i].samples));
  if (report.damaged.size() > kListed)
    table.add("", fmt::format("and {} more rectangles; --json lists them", counted(report.damaged.size() - kListed)));
  table.add("verdict", verdict(made, tolerance, true));
  if (report.is_damaged()) table.add("", advice(made));
  return table;
}

/// Standard error says it too, for whoever does not look at the exit code.
Exit say(const Request& request, const Checked& checked, Exit code) {
  if (code == Exit::done) return code;
  const VerifyReport& report = checked.report;
  const std::string first = report.findings.empty() ? "the surface lies beyond its bound" : report.findings.front();
  fmt::print(stderr, "talus: {} {}: {}\n", request.database,
             code == Exit::corrupt ? "is damaged" : "does not keep to its source", first);
  return code;
}

Exit run(const Request& request) {
  std::optional<Metres> tolerance;
  if (!request.tolerance.empty()) {
    if (request.against.empty()) {
      throw Failure(Cause::invalid_argument, "--tolerance needs --against: the true error is measured on the raster");
    }
    tolerance = parse_tolerance(request.tolerance);
  }
  const Checked report = check(request, tolerance);
  if (request.json) {
    print(to_json(report, tolerance));
  } else {
    print(to_table(request, report, tolerance));
  }
  return say(request, report, exit_of(report, tolerance));
}

}  // namespace

void add_verify(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("verify", "Check a database, and hold it against its raster");
  command->add_option("DATABASE", request->database, "Database file")->required()->check(is_named);
  command->add_option("--against", request->against, "What the database was made from: rasters, folders, @LIST.txt")
      ->option_text("DEM")
      ->check(is_named);
  add_input_options(*command, request->inputs);
  command->add_option("--tolerance", request->tolerance, "Metres, 0 or more, or inf; needs --against")
      ->option_text("M");
  command->add_flag("--json", request->json, "Print one JSON object");
  command->footer(
      "\n"
      "Check a database against itself: the file's trees and seal, every page, what two places both hold, errors,\n"
      "records and coarse levels computed again from the samples, and answers at 0 and at 1, 2, 5 ... metres.\n"
      "It goes on after the first damage, lists the damaged rectangles, and says what to do.\n"
      "\n"
      "With --against also every stored sample against the raster, bit for bit, or within what --height-step of\n"
      "ingest rounded. The raster is read by other code than ingest's; name the options for inputs that ingest had.\n"
      "With --tolerance also the true error, in metres, of that answer: its mesh laid over every sample.\n"
      "\n"
      "Exit code 3: damaged. 5: sound, but it differs from its source, or a surface lies beyond its bound.\n"
      "\nExample:\n  talus verify alps.talus --against alps.tif --tolerance 2");
  command->callback([request, &action] { action = [request] { return run(*request); }; });
}

}  // namespace talus::app
