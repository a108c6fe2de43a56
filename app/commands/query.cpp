#include <chrono>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/options/outputs.hpp"
#include "app/options/required_points.hpp"
#include "app/options/shared_options.hpp"
#include "app/terminal/explain.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
#include "talus/database.hpp"
#include "talus/stream.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database, tolerance_raster;
  std::optional<Metres> tolerance;
  std::optional<Rectangle> bbox;
  std::optional<Focus> focus;
  std::int32_t snap = 1;
  Question question;
  std::vector<std::string> outputs, neighbours;
  Places places;
  StreamOptions stream;
  bool json = false, explain = false;
};

std::vector<std::string> inputs_of(const Request& request) {
  std::vector<std::string> inputs{request.database};
  for (const auto* files : {&request.neighbours, &request.places.point_files, &request.places.line_files})
    inputs.insert(inputs.end(), files->begin(), files->end());
  if (!request.tolerance_raster.empty()) inputs.push_back(request.tolerance_raster);
  return inputs;
}

std::string why_empty(GridRect region) {
  if (region.cols() == 1 || region.rows() == 1) return "no triangle: the rectangle is one sample wide or high";
  return "no triangle: the rectangle has no three neighbouring samples with data";
}

std::vector<RestrictedQuadtree> read_neighbours(const std::vector<std::string>& files) {
  std::vector<RestrictedQuadtree> neighbours;
  for (const std::string& file : files) {
    require_stream(file);
    Stream stream = read_stream(file);
    neighbours.push_back(answer_of(stream, file));
  }
  return neighbours;
}

/// Completes the question that the options began, as far as no database is needed.
Question question_of(const Request& request, const std::vector<RestrictedQuadtree>& neighbours) {
  Question question = request.question;
  question.tolerance = request.tolerance.value_or(Metres{0});
  Places places = with_files_read(request.places);
  question.places = std::move(places.points);
  question.lines = std::move(places.lines);
  for (const RestrictedQuadtree& neighbour : neighbours) question.neighbours.push_back(&neighbour);
  return question;
}

/// Refuses options that do not go together, before a database is opened or a raster of tolerances is read.
void require_combinable_options(const Request& request, Question question) {
  if (request.focus || !request.tolerance_raster.empty())
    question.field = patch_tolerance({{0, 0}, {1, 1}}, 1, 1, {0});  // stands for the one to come
  require_combinable(question);
}

/// Adds the region, and the tolerances that depend on it.
void place(Question& question, const Request& request, const Snapshot& now, Stages& stages) {
  const Description& d = now.description();
  question.region = snapped(request.bbox ? now.region(*request.bbox).samples : d.extent, request.snap, d.extent);
  if (!request.tolerance_raster.empty()) {
    stages.time("read the tolerances",
                [&] { question.field = tolerance_of_raster(request.tolerance_raster, d, question.region); });
  }
  if (request.focus)
    question.field =
        focus_tolerance(d, request.focus->x, request.focus->y, request.focus->metres_per_metre, question.tolerance);
}

void require_fit_for_streams(const Request& request) {
  for (const std::string& output : request.outputs) {
    if (!is_stream_file(output) || request.question.border != Border::clip) continue;
    throw Failure(Cause::invalid_argument,
                  fmt::format("--output {}: an .rqt file cannot hold a mesh that --border clip has cut; use --border "
                              "cover, or write another format",
                              output));
  }
}

/// Exactly one option says how exact the answer is.
void require_tolerance(const Request& request) {
  const bool has_budget = request.question.budget.vertices > 0 || request.question.budget.triangles > 0;
  const bool has_raster = !request.tolerance_raster.empty();
  const int said = int{has_budget} + int{has_raster} + int{request.tolerance.has_value()};
  if (said != 1) {
    throw Failure(Cause::invalid_argument,
                  said == 0 ? "query needs --tolerance M, or one of these instead: --max-vertices, --max-triangles or "
                              "--tolerance-raster"
                            : "--tolerance, --max-vertices or --max-triangles, and --tolerance-raster all say how "
                              "exact: give one of them");
  }
  if (has_raster && request.focus)
    throw Failure(Cause::invalid_argument, "--focus does not go with --tolerance-raster: remove one of them");
}

/// Notes for the reader.
std::vector<std::string> remarks_on(const Request& request, const Answer& answer, const Mesh& mesh, bool is_clipped) {
  std::vector<std::string> remarks;
  if (is_clipped) remarks.push_back(clipped_text(*request.bbox));
  if (mesh.triangles.empty()) remarks.push_back(why_empty(mesh.region));
  if (request.snap < 16 && request.question.budget.triangles + request.question.budget.vertices > 0 &&
      mesh.size() > 1000 && 3 * answer.border_vertices > mesh.size()) {
    remarks.push_back(fmt::format(
        "{} of the {} vertices only let neighbouring rectangles meet; with --snap 16 more are left for the terrain",
        counted(answer.border_vertices), counted(mesh.size())));
  }
  if (!answer.unmatched.empty()) {
    remarks.push_back(
        fmt::format("the mesh has cracks: the neighbours lack {} of its vertices on shared sides; ask for them again "
                    "with --match",
                    counted(answer.unmatched.size())));
  }
  if (answer.void_points > 0) {
    remarks.push_back(
        fmt::format("{} samples at points and lines have no data and are no vertices", counted(answer.void_points)));
  }
  if (request.outputs.empty()) remarks.push_back("nothing was written; add -o FILE to keep the mesh");
  return remarks;
}

/// Ends what is printed.
void conclude(Json& object, const Request& request, const std::vector<std::string>& remarks, const QueryCost& cost,
              double seconds, const Stages& stages) {
  add_cost(object, cost, seconds);
  object["output"] = request.outputs;
  object["notes"] = remarks;
  if (request.explain) object["explain"] = explained(cost, stages);
  print(object);
}
void conclude(Table& table, const Request& request, const QueryCost& cost, double seconds, const Stages& stages) {
  add_cost(table, cost, seconds);
  for (const std::string& output : request.outputs) table.add("output", output);
  print(table.text() + (request.explain ? explained_text(cost, stages) : ""));
}

/// query --from
Exit write_increment(const Request& request, const Snapshot& now, const Question& question) {
  for (const std::string& output : request.outputs) require_ending(output, "an increment (--from)", {".rqt"});
  const Description& description = now.description();
  Answer answer = now.ask(question);
  Stages stages;
  if (answer.search.pages_read > 0) stages.add_search(answer.search);
  const Increment increment = increment_of(std::move(answer));
  const RestrictedQuadtree& added = increment.added;
  stages.add(increment.cost);
  const auto write = [&] {
    const RestrictedQuadtree base = now.ask({.region = question.region,
                                             .tolerance = increment.from,
                                             .heights = question.heights,
                                             .threads = question.threads})
                                        .quadtree;
    for (const std::string& output : request.outputs) {
      const HoldInterrupts whole_file_or_none;
      write_stream({description, increment}, output, request.stream, &base);
    }
  };
  std::vector<std::string> remarks;
  if (request.outputs.empty())
    remarks.push_back("nothing was written; add -o FILE.rqt to keep the increment");
  else
    stages.time("write", write);
  notes(remarks);
  if (request.json) {
    Json object{{"region", bounds(description, question.region)}, {"from", increment.from.value}};
    add_bound(object, description, added.tolerance, added.bound);
    object["vertices"] = added.vertices.size();
    conclude(object, request, remarks, increment.cost, increment.cost.seconds, stages);
    return Exit::done;
  }
  Table table;
  table.add("region", bounds_text(description, question.region));
  table.add("from", metres(increment.from.value));
  add_bound(table, description, added.tolerance, added.bound);
  table.add("added", fmt::format("{} vertices", counted(added.vertices.size())));
  conclude(table, request, increment.cost, increment.cost.seconds, stages);
  return Exit::done;
}

/// An answer, and what is printed of it.
struct Result {
  const Request& request;
  const Description& description;
  const Question& question;
  const Answer& answer;
  const Mesh& mesh;
  Metres tolerance, bound;
  bool is_clipped;
};

Json json_of(const Result& r) {
  Json object{{"region", bounds(r.description, r.mesh.region)}};
  add_bound(object, r.description, r.tolerance, r.bound);
  object.update({{"vertices", r.mesh.size()},
                 {"triangles", r.mesh.triangles.size()},
                 {"quantum", r.answer.quadtree.origin.quantum.value},
                 {"border_vertices", r.answer.border_vertices},
                 {"matching_vertices", r.answer.matching_vertices},
                 {"unmatched_vertices", r.answer.unmatched.size()},
                 {"point_vertices", r.answer.point_vertices},
                 {"void_points", r.answer.void_points}});
  if (r.request.bbox) add_rectangle(object, *r.request.bbox, r.is_clipped);
  return object;
}

Table table_of(const Result& r) {
  const std::string& raster = r.request.tolerance_raster;
  const auto extra = [](std::uint64_t vertices, const char* why) {
    return fmt::format("{} extra vertices{}", counted(vertices), why);
  };
  Table table;
  table.add("region", bounds_text(r.description, r.mesh.region));
  add_bound(table, r.description, r.tolerance, r.bound);
  if (!raster.empty()) table.add("varies", fmt::format("{} or more, by {}", metres(r.tolerance.value), raster));
  if (const std::string why = why_coarser(r.description, r.tolerance); !why.empty()) table.add("", why);
  table.add("mesh", mesh_text(r.mesh.size(), r.mesh.triangles.size()));
  if (r.question.heights.kind != HeightKind::exact)
    table.add("heights", heights_text(r.answer.quadtree.origin.quantum));
  table.add("border", r.question.border == Border::constrain
                          ? extra(r.answer.border_vertices, ", so that neighbouring rectangles meet")
                          : name_of(r.question.border));
  if (!r.question.neighbours.empty()) table.add("match", extra(r.answer.matching_vertices, " to meet the neighbours"));
  if (!r.request.places.is_empty()) {
    table.add("points",
              fmt::format("{} samples, {}", counted(r.answer.points), extra(r.answer.point_vertices, " for them")));
  }
  return table;
}

Exit run(Request& request) {
  require_tolerance(request);
  require_fit_for_streams(request);
  check_outputs(request.outputs, inputs_of(request));
  const int threads = request.stream.threads = request.question.threads;
  const std::vector<RestrictedQuadtree> neighbours = read_neighbours(request.neighbours);
  Question question = question_of(request, neighbours);
  require_combinable_options(request, question);

  const Snapshot now = open_database(request.database, {.threads = threads}).snapshot();
  const Description& description = now.description();
  const bool is_clipped = request.bbox && now.region(*request.bbox).is_cut;
  const auto start = std::chrono::steady_clock::now();
  Stages stages;
  place(question, request, now, stages);
  if (question.from) {
    if (is_clipped) note(clipped_text(*request.bbox));
    return write_increment(request, now, question);
  }
  const Answer answer = now.ask(question);
  const bool by_raster = !request.tolerance_raster.empty();
  const Metres tolerance = by_raster        ? question.field->least(question.region)
                           : question.field ? question.tolerance
                                            : answer.quadtree.tolerance;
  if (!request.tolerance && !by_raster) stages.add_search(answer.search);
  stages.add(answer.cost);
  Mesh mesh = stages.time("triangulate", [&] { return triangulate(answer.quadtree, threads); });
  if (question.border == Border::clip && request.bbox)
    mesh = stages.time("cut", [&] { return clip_mesh(mesh, now.region(*request.bbox).frame); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  Metres bound = answer.quadtree.bound;
  if (!request.outputs.empty()) {
    stages.time("write", [&] {
      bound = bound + write_outputs(answer.quadtree, mesh, description, request.outputs, request.stream);
    });
  }

  const std::vector<std::string> remarks = remarks_on(request, answer, mesh, is_clipped);
  notes(remarks);
  const Result result{request, description, question, answer, mesh, tolerance, bound, is_clipped};
  if (request.json) {
    Json object = json_of(result);
    conclude(object, request, remarks, answer.cost, seconds, stages);
  } else {
    Table table = table_of(result);
    conclude(table, request, answer.cost, seconds, stages);
  }
  return Exit::done;
}

constexpr const char* kAbout =
    "The mesh has no cracks, and every sample under it lies within the tolerance. Heights are in the vertical unit of "
    "the source. Answers at one tolerance meet without cracks where rectangles share a whole side and are 16 cells "
    "deep or more.\n"
    "\nExamples:\n"
    "  talus query alps.talus --tolerance 2 --bbox=7.5,45.9,7.8,46.1 -o matterhorn.ply -o matterhorn.png\n"
    "  talus query alps.talus --max-triangles 100000 -o overview.ply\n"
    "  talus query alps.talus --tolerance 0.5 --focus=7.66,45.98,0.01 -o view.ply\n"
    "  talus query alps.talus --tolerance 20 --point=7.66,45.98 --lines roads.txt -o roads.ply\n"
    "  talus query alps.talus --tolerance 2 --explain\n"
    "  talus query alps.talus --tolerance 1 --bbox=7.5,45.9,7.7,46.1 -o west.ply -o west.rqt\n"
    "  talus query alps.talus --tolerance 20 --bbox=7.7,45.9,7.9,46.1 --match west.rqt -o east.ply";

}  // namespace

void add_query(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  Question& question = request->question;
  Command command(program, "query", "Make a mesh of a rectangle at a tolerance");
  command.database(request->database);

  command.group("Most used");
  command.option("--tolerance", request->tolerance, kTolerance, "M",
                 "Tolerance in metres, 0 or more, or inf. talus help tolerance says more");
  command.bbox(request->bbox,
               "Rectangle, in the database's CRS. Default: the whole raster. talus help places says more");
  command.files("-o,--output", request->outputs, "OUT",
                "File to write; the ending is the format: .ply, .obj, .glb, .tif, .png or .rqt. Can be repeated. talus "
                "help outputs says more");

  command.group("Other ways to set the tolerance");
  constexpr std::int64_t kMost = std::int64_t{1} << 53;
  command.number("--max-triangles", question.budget.triangles, "N",
                 "Use the smallest tolerance (to within 0.6 %) whose mesh has at most N triangles", 1, kMost);
  command.number("--max-vertices", question.budget.vertices, "N",
                 "The same for vertices. Some vertices beside voids are in no triangle; they count too", 1, kMost);
  command.option(
      "--focus", request->focus, kFocus, "X,Y,M",
      "Keep --tolerance at the point X,Y. It grows by M metres with each metre of distance on the ground: 0.01 is "
      "10 m for each kilometre");
  command.file(
      "--tolerance-raster", request->tolerance_raster, "FILE",
      "Raster with a tolerance in metres for each cell, at most 1000000. It has one band, covers the rectangle "
      "and is in the database's CRS. Without a place of its own it is stretched over the rectangle");
  command.number("--max-level", question.max_level, "L",
                 "Leave out levels finer than L; 0 is the coarsest. The bound says what that costs", 0, 31);

  command.group("Border");
  add_border_option(command, question.border);
  command.number("--snap", request->snap, "N",
                 "Grow the rectangle to multiples of N samples. 16 needs the fewest extra vertices. Default: 1", 1);
  command.files("--match", request->neighbours, "NEIGHBOUR.rqt",
                "Take the vertices on a shared side from this answer, so that both meet at any tolerances. Ask for the "
                "finer one first. Can be repeated");

  add_places(command, request->places);

  add_height_options(command.group("Heights and .rqt files"), question.heights);
  command.option("--from", question.from, kTolerance, "M",
                 "Write an increment: only what the answer lacks at M metres. talus help streams says more");
  add_stream_options(command, request->stream);

  command.group("Other");
  command.flag("--explain", request->explain, "Print which pages were read, which were not and why, and the time");
  command.threads(question.threads);
  command.finish(action, request, run, kAbout);
}

}  // namespace talus::app
