#include <algorithm>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/options/shared_options.hpp"
#include "app/terminal/fields.hpp"
#include "app/terminal/report.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database;
  bool json = false;
};

std::string crs_name(const Description& d) {
  if (d.crs_wkt.empty()) return "none: a cell counts as one metre";
  return d.crs.name.empty() ? "unnamed" : d.crs.name;
}

std::string step_text(const HeightStep& step, const std::string& unit) {
  if (!step.integer) return "none: heights are floats, as in the source";
  const std::string size = fmt::format("{} {}", step.scale / step.divisor, unit);
  return step.offset == 0 ? size : fmt::format("{} above {} {}", size, step.offset, unit);
}

/// Vertices above tolerances. Earlier versions kept a list for each update; the latest is at the end.
std::vector<std::pair<double, std::uint64_t>> latest_counts(const Provenance& p) {
  std::size_t first = 0;
  for (std::size_t i = 1; i < p.vertices_above.size(); ++i) {
    if (p.vertices_above[i].first <= p.vertices_above[i - 1].first) first = i;
  }
  return {p.vertices_above.begin() + static_cast<std::ptrdiff_t>(first), p.vertices_above.end()};
}

Json to_json(const Request& request, const Description& d, const StorageSummary& s, const Provenance& p) {
  Json sources = Json::array();
  for (const SourceFile& f : p.sources) {
    sources.push_back({{"name", f.name},
                       {"driver", f.driver},
                       {"type", f.type},
                       {"cols", f.cols},
                       {"rows", f.rows},
                       {"bytes", f.bytes},
                       {"xxh3", fmt::format("{:016x}", f.checksum)}});
  }
  Json above = Json::array();
  for (const auto& [tolerance, vertices] : latest_counts(p))
    above.push_back({{"tolerance", tolerance}, {"vertices", vertices}});
  Json bands = Json::array();
  for (const BandSummary& band : s.bands) {
    bands.push_back({{"spacing", band.spacing}, {"pages", band.pages}, {"bytes", band.bytes}});
  }
  return Json{
      {"database", request.database},
      {"format_version", s.format_version},
      {"source", d.source_name},
      {"type", d.source_type},
      {"cols", d.extent.cols()},
      {"rows", d.extent.rows()},
      {"region", bounds(d, d.extent)},
      {"cell", {d.mapping.dx, -d.mapping.dy}},
      {"crs", d.crs_wkt},
      {"vertical_unit", d.vertical_unit},
      {"metres_per_unit", d.metres_per_unit},
      {"height_step",
       {{"scale", d.step.scale}, {"divisor", d.step.divisor}, {"offset", d.step.offset}, {"integer", d.step.integer}}},
      {"minimum", d.minimum_height},
      {"maximum", d.maximum_height},
      {"void_samples", d.void_samples},
      {"void_weight", d.void_weight},
      {"error_metric", name_of(d.error_metric)},
      {"file_bytes", s.file_bytes},
      {"pages", s.pages},
      {"page_bytes", s.page_bytes},
      {"slices", s.slices},
      {"slice_bytes", s.slice_bytes},
      {"bands", bands},
      {"lossy_metres", d.lossy.value},
      {"finest_tolerance", d.finest_tolerance.value},
      {"made_by", with_options(p.made_by)},
      {"generation", p.generation},
      {"sources", sources},
      {"vertices_above", above}};
}

/// The entries that help a reader: neither nearly all vertices nor nearly none.
std::string above_text(const Provenance& p) {
  std::string text;
  for (const auto& [tolerance, vertices] : latest_counts(p)) {
    if (vertices < 16 || tolerance < 0.1) continue;
    text += fmt::format("{}{} m: {}", text.empty() ? "" : ", ", tolerance, counted(vertices));
  }
  return text;
}

Table to_table(const Request& request, const Description& d, const StorageSummary& s, const Provenance& p) {
  const auto samples = static_cast<std::uint64_t>(d.extent.samples());
  Table table;
  table.add("database", fmt::format("{}, format {}", request.database, s.format_version));
  table.add("file size", file_size(s.file_bytes, d.extent));
  table.add("source", fmt::format("{}, {}", d.source_name, d.source_type));
  table.add("samples", fmt::format("{} x {}, {} of {} void", d.extent.cols(), d.extent.rows(), counted(d.void_samples),
                                   counted(samples)));
  table.add("region", bounds_text(d, d.extent));
  table.add("cell", fmt::format("{} x {}", d.mapping.dx, -d.mapping.dy));
  table.add("crs", crs_name(d));
  table.add("heights",
            fmt::format("{} to {} {}", rounded(d.minimum_height), rounded(d.maximum_height), d.vertical_unit));
  table.add("height step", step_text(d.step, d.vertical_unit));
  table.add("errors", name_of(d.error_metric));
  table.add("void weight", fmt::format("{}", d.void_weight));
  if (d.lossy.value > 0)
    table.add("rounded", fmt::format("heights by up to {} m; every bound includes it", d.lossy.value));
  if (d.finest_tolerance.value > 0)
    table.add("kept", fmt::format("only the vertices for {} m and coarser", d.finest_tolerance.value));
  if (const std::string above = above_text(p); !above.empty()) table.add("vertices above", above);
  table.add("made by", p.generation == 0 ? with_options(p.made_by)
                                         : fmt::format("{}, updated {} times", with_options(p.made_by), p.generation));
  constexpr std::size_t kListed = 8;
  for (std::size_t i = 0; i < std::min(kListed, p.sources.size()); ++i) {
    const SourceFile& f = p.sources[i];
    table.add(i == 0 ? "from" : "", fmt::format("{}: {}, {} x {} of {}, {}, XXH3 {:016x}", f.name, f.driver, f.cols,
                                                f.rows, f.type, sized(f.bytes), f.checksum));
  }
  if (p.sources.size() > kListed)
    table.add("", fmt::format("and {} more; --json lists them", p.sources.size() - kListed));
  table.add("pages", fmt::format("{}, {} of the file", counted(s.pages), sized(s.page_bytes)));
  for (const BandSummary& band : s.bands) {
    table.add("", fmt::format("spacing {:>6}: {:>9} pages, {}", band.spacing, counted(band.pages), sized(band.bytes)));
  }
  if (s.slices > 0) table.add("slices", fmt::format("{}, {} of the file", counted(s.slices), sized(s.slice_bytes)));
  return table;
}

/// Reads no vertices.
Exit run_stream(const Request& request) {
  require_stream(request.database);
  const StreamInfo s = read_stream_info(request.database);
  const Description& d = s.description;
  if (request.json) {
    Json parts = Json::array();
    for (const StreamPart& part : s.parts)
      parts.push_back({{"vertices", part.vertices}, {"bytes", part.bytes}, {"bound", part.bound.value}});
    Json object{{"stream", request.database},
                {"increment", s.is_increment},
                {"region", bounds(d, s.region)},
                {"border", name_of(s.origin.border)}};
    add_bound(object, d, s.tolerance, s.bound);
    object.update({{"quantum", s.origin.quantum.value},
                   {"vertices", s.vertices},
                   {"bytes", s.bytes},
                   {"header_bytes", s.header_bytes},
                   {"identity", fmt::format("{:016x}", s.origin.identity.content)},
                   {"generation", s.origin.identity.generation},
                   {"crs", d.crs_wkt},
                   {"vertical_unit", d.vertical_unit},
                   {"parts", parts}});
    if (s.is_increment) object["from"] = s.from.value;
    print(object);
    return Exit::done;
  }
  Table table;
  table.add("stream", fmt::format("{}, {}", request.database, s.is_increment ? "an increment" : "an answer"));
  table.add("region", bounds_text(d, s.region));
  table.add("crs", crs_name(d));
  table.add("border", name_of(s.origin.border));
  if (s.is_increment) table.add("from", metres(s.from.value));
  add_bound(table, d, s.tolerance, s.bound);
  table.add("heights", heights_text(s.origin.quantum));
  table.add("vertices", counted(s.vertices));
  table.add("size", fmt::format("{}, {:.2f} bits a vertex, the header takes {}", sized(s.bytes),
                                8.0 * static_cast<double>(s.bytes) /
                                    static_cast<double>(std::max<std::uint64_t>(1, s.vertices)),
                                sized(s.header_bytes)));
  table.add("database", fmt::format("{:016x}, {} updates", s.origin.identity.content, s.origin.identity.generation));
  for (std::size_t i = 0; i < s.parts.size(); ++i) {
    table.add(i == 0 ? "parts" : "",
              fmt::format("{:>2}: {:>11} vertices, {:>9}, bound {}", i, counted(s.parts[i].vertices),
                          sized(s.parts[i].bytes), metres(s.parts[i].bound.value)));
  }
  print(table);
  return Exit::done;
}

Exit run(Request& request) {
  if (holds_stream(request.database)) return run_stream(request);
  const Snapshot now = open_database(request.database).snapshot();
  if (request.json) {
    print(to_json(request, now.description(), now.storage(), now.provenance()));
  } else {
    print(to_table(request, now.description(), now.storage(), now.provenance()));
  }
  return Exit::done;
}

}  // namespace

void add_info(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  Command command(program, "info", "Show what a database or an .rqt file holds");
  command.database(request->database, "Database or .rqt file");
  command.finish(
      action, request, run,
      "Coordinates are in the database's CRS and name pixel centres. Heights are in the vertical unit of the "
      "source. Pages are what a query reads; the list has a line for each distance, in cells, between their "
      "finest vertices.\n"
      "\nExamples:\n  talus info alps.talus\n  talus info west.rqt");
}

}  // namespace talus::app
