#include <algorithm>
#include <cctype>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/files/truth.hpp"
#include "app/options/shared_options.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database;
  std::optional<Metres> tolerance;
  std::vector<std::string> against;
  InputOptions inputs;
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

/// A file whose header is damaged cannot be checked any further.
Snapshot open_or_advise(const std::string& database) {
  require_database(database);  // another kind of file needs no backup
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
    options.truth = open_truth(request.against, request.inputs, made.description, request.database);
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
  return (checked.report.damaged.empty() ? "answers are right, but the file has changed since it was made; "
                                         : "answers that read nothing from the damaged rectangles are right; ") +
         restore;
}

// Doubles are rounded: a nanometre, and a relative error of 10^-12, are no findings.
bool is_within(Metres error, Metres tolerance, double part) {
  return error.value <= tolerance.value * (1 + part) + 1e-9;
}

/// Whether the measured surface keeps its bound.
bool is_within_bound(const Checked& checked, std::optional<Metres> tolerance) {
  const VerifyReport& report = checked.report;
  if (!tolerance || !report.true_error) return true;
  const Description& d = checked.description;
  const Metres promised{std::max({tolerance->value, d.lossy.value, d.finest_tolerance.value})};
  // Cells in degrees are measured in two ways, which differ by a millionth.
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
  if (checked.report.differences > 0) return with_details ? "DIFFERS FROM ITS SOURCE (sound in itself)" : "DIFFERS";
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
    table.add("mesh", mesh_text(report.vertices, report.triangles));
    table.add("tolerance", tolerance ? metres(tolerance->value) : "the finest that the database has");
    if (const std::string why = tolerance ? why_coarser(made.description, *tolerance) : ""; !why.empty())
      table.add("", why);
    table.add("true error",
              fmt::format("{}, over all samples with data under the mesh", metres(report.true_error->value)));
    if (report.perpendicular_error)
      table.add("", fmt::format("{} at right angles to the triangles, as the tolerance is measured",
                                metres(report.perpendicular_error->value)));
    table.add("covered", fmt::format("{} samples", counted(report.covered_samples)));
    if (report.uncovered_samples > 0) {
      table.add("uncovered",
                fmt::format("{} samples that should lie under a triangle do not", counted(report.uncovered_samples)));
    }
    if (report.stray_samples > 0) {
      table.add("stray", fmt::format("{} samples with data have too few neighbours with data for a triangle",
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

/// For a reader who does not look at the exit code.
Exit report_on(const Request& request, const Checked& checked, Exit code) {
  if (code == Exit::done) return code;
  const VerifyReport& report = checked.report;
  const std::string first = report.findings.empty() ? "a sample lies beyond the bound" : report.findings.front();
  say(fmt::format("{} {}: {}", request.database, code == Exit::corrupt ? "is damaged" : "differs from its source",
                  first));
  return code;
}

Exit run(Request& request) {
  const std::optional<Metres> tolerance = request.tolerance;
  if (tolerance && request.against.empty())
    throw Failure(Cause::invalid_argument, "--tolerance needs --against: the error is measured on the raster");
  const Checked report = check(request, tolerance);
  if (request.json) {
    print(to_json(report, tolerance));
  } else {
    print(to_table(request, report, tolerance));
  }
  return report_on(request, report, exit_of(report, tolerance));
}

}  // namespace

void add_verify(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  Command command(program, "verify", "Check a database, and compare it with its source");
  command.database(request->database);
  command.group("Most used");
  command.file("--against", request->against, "DEM...",
               "Compare every sample with these rasters, folders or @LIST.txt, from which the database was made");
  command.option("--tolerance", request->tolerance, kTolerance, "M",
                 "Measure the error of the answer at this tolerance in metres, on every sample. Needs --against");
  add_input_options(command, request->inputs);
  command.finish(
      action, request, run,
      "Checks the checksum of the file, every page, and the samples that two pages share. Computes errors, records and "
      "coarse levels again from the samples, and asks for answers at 0 and at 1, 2, 5 ... metres. After the first "
      "damage "
      "it goes on, lists the damaged rectangles, and says what to do.\n"
      "\n"
      "With --against the raster is read by other code than that of ingest. Samples must be equal, or within what "
      "--height-step rounded. Repeat the options for reading rasters that ingest had.\n"
      "\n"
      "Exit code 3: damaged. 5: sound, but it differs from its source, or a sample lies beyond the bound.\n"
      "\nExample:\n  talus verify alps.talus --against alps.tif --tolerance 2");
}

}  // namespace talus::app
