#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/doors.hpp"
#include "app/report.hpp"
#include "app/truth.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database, tolerance;
  std::vector<std::string> against;
  bool json = false;
};

struct Checked {
  VerifyReport report;
  Description description;
  [[nodiscard]] bool keeps_bound() const { return description.error_kind != ErrorKind::midpoint; }
};

Checked check(const Request& request, std::optional<Metres> tolerance) {
  const Snapshot now = open_database(request.database).snapshot();
  const Description& d = now.description();
  if (request.against.empty()) return {verify(now), d};
  const SampleReader truth = open_truth(request.against, d, request.database);
  return {tolerance ? verify(now, truth, *tolerance) : verify(now, truth), d};
}

// The surface is double arithmetic on heights: a nanometre, and a part in 10¹², is rounding.
bool is_within(Metres error, Metres tolerance, double part) { return error.value <= tolerance.value * (1 + part) + 1e-9; }

bool is_sound(const Checked& checked, std::optional<Metres> tolerance) {
  const VerifyReport& report = checked.report;
  if (report.finding_count > 0 || report.uncovered_samples > 0) return false;
  if (!tolerance || !report.true_error || !checked.keeps_bound()) return true;
  const Description& d = checked.description;
  const Metres promised{std::max({tolerance->value, d.lossy_metres, d.finest_tolerance})};
  // Cells of degrees are measured in two ways here and there: a millionth.
  return report.perpendicular_error ? is_within(*report.perpendicular_error, promised, 1e-6)
                                    : is_within(*report.true_error, promised, 1e-12);
}

Json to_json(const Checked& checked, std::optional<Metres> tolerance) {
  const VerifyReport& report = checked.report;
  Json json{{"pages", report.pages},
            {"samples", report.samples},
            {"findings", report.findings},
            {"finding_count", report.finding_count}};
  if (report.true_error) {
    json["true_error"] = report.true_error->value;
    if (report.perpendicular_error) json["perpendicular_error"] = report.perpendicular_error->value;
    json["keeps_bound"] = checked.keeps_bound();
    if (tolerance) json["tolerance"] = tolerance->value;
    json["vertices"] = report.vertices;
    json["triangles"] = report.triangles;
    json["covered_samples"] = report.covered_samples;
    json["uncovered_samples"] = report.uncovered_samples;
    json["stray_samples"] = report.stray_samples;
  }
  return json;
}

/// How far the answers of a database that keeps no bound are off.
std::string beyond(const VerifyReport& report, Metres tolerance) {
  const double error = (report.perpendicular_error ? *report.perpendicular_error : *report.true_error).value;
  if (error <= tolerance.value) return "this answer happens to be within it; errors of midpoints do not say so beforehand";
  const std::string times = tolerance.value > 0 ? fmt::format(", {:.3g} times the tolerance", error / tolerance.value) : "";
  return fmt::format("{} m beyond it{}: errors of midpoints bound nothing", rounded(error - tolerance.value), times);
}

Table to_table(const Request& request, const Checked& made, std::optional<Metres> tolerance) {
  const VerifyReport& report = made.report;
  Table table;
  std::string checked = fmt::format("{} pages", counted(report.pages));
  if (!request.against.empty()) {
    checked += fmt::format(", {} samples against {}", counted(report.samples), name_of(request.against));
  }
  table.add("checked", checked);
  if (report.true_error) {
    table.add("mesh", fmt::format("{} vertices, {} triangles", counted(report.vertices), counted(report.triangles)));
    table.add("tolerance", tolerance ? metres(tolerance->value) : "the finest of the database");
    if (const std::string why = tolerance ? why_coarser(made.description, *tolerance) : ""; !why.empty()) table.add("", why);
    table.add("true error", fmt::format("{}, over all valid samples under the mesh", metres(report.true_error->value)));
    if (report.perpendicular_error)
      table.add("", fmt::format("{} at right angles to triangles, which is what the tolerance is about", metres(report.perpendicular_error->value)));
    if (!made.keeps_bound() && tolerance) table.add("bound", beyond(report, *tolerance));
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
  table.add("verdict", is_sound(made, tolerance) ? (made.keeps_bound() ? "sound" : "sound, without any bound") : "NOT SOUND");
  return table;
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
  return is_sound(report, tolerance) ? Exit::done : Exit::corrupt;
}

}  // namespace

void add_verify(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("verify", "Check a database, and hold it against its raster");
  command->add_option("DATABASE", request->database, "Database file")->required()->check(is_named);
  command->add_option("--against", request->against, "What the database was made from: rasters, folders, @LIST.txt")
      ->option_text("DEM")
      ->check(is_named);
  command->add_option("--tolerance", request->tolerance, "Metres, 0 or more, or inf; needs --against")
      ->option_text("M");
  command->add_flag("--json", request->json, "Print one JSON object");
  command->footer(
      "\n"
      "Check a database: every page's checksum and content, page tables against pages, errors never below\n"
      "their children's. With --against also every stored sample against the raster, bit for bit, or within what\n"
      "--height-step of ingest rounded; with --tolerance also the true error, in metres, of that answer: its mesh laid\n"
      "over every sample.\n"
      "\n"
      "Exit code 3 if anything is wrong.\n"
      "\nExample:\n  talus verify alps.talus --against alps.tif --tolerance 2");
  command->callback([request, &action] { action = [request] { return run(*request); }; });
}

}  // namespace talus::app
