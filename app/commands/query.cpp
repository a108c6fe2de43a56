#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/increment.hpp"
#include "app/files/named_files.hpp"
#include "app/options/arguments.hpp"
#include "app/options/outputs.hpp"
#include "app/options/places.hpp"
#include "app/options/stream_answer.hpp"
#include "app/options/stream_options.hpp"
#include "app/terminal/explain.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database, tolerance, from, bbox, border = "constrain", focus, tolerance_raster;
  std::int32_t snap = 1;
  int max_level = -1, threads = 0;
  Budget budget;
  std::vector<std::string> outputs, neighbours;
  Interest interest;
  StreamOptions stream;
  HeightWords heights;
  bool json = false, explain = false;
};

/// All that is read.
std::vector<std::string> inputs_of(const Request& request) {
  std::vector<std::string> inputs{request.database};
  for (const auto* files : {&request.neighbours, &request.interest.point_files, &request.interest.line_files})
    inputs.insert(inputs.end(), files->begin(), files->end());
  if (!request.tolerance_raster.empty()) inputs.push_back(request.tolerance_raster);
  return inputs;
}

std::string why_empty(GridRect region) {
  if (region.cols() == 1 || region.rows() == 1) return "no triangle: the region is one sample wide or high";
  return "no triangle: the region holds no three neighbouring samples of data";
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

/// What words alone say of a question: region and field are still to come.
Question words_of(const Request& request, Places places, const std::vector<RestrictedQuadtree>& neighbours) {
  Question question;
  question.border = parse_border(request.border);
  if (request.max_level >= 0) question.max_level = request.max_level;
  question.places = std::move(places.points);
  question.lines = std::move(places.lines);
  for (const RestrictedQuadtree& neighbour : neighbours) question.neighbours.push_back(&neighbour);
  question.budget = request.budget;
  if (!request.tolerance.empty()) question.tolerance = parse_tolerance(request.tolerance);
  if (!request.from.empty()) question.from = parse_tolerance(request.from, "--from");
  question.heights = request.heights.heights();
  question.threads = request.threads;
  return question;
}

/// Refuses what does not go together before a database is opened or a raster of tolerances read.
void require_combinable_words(const Request& request, Question question) {
  if (!request.focus.empty() || !request.tolerance_raster.empty())
    question.field = patch_tolerance({{0, 0}, {1, 1}}, 1, 1, {0});  // stands for the one to come
  require_combinable(question);
}

/// The rest of the question.
void place(Question& question, const Request& request, const Snapshot& now, const std::optional<Rectangle>& rectangle,
           Stages& stages) {
  const Description& d = now.description();
  question.region = snapped(rectangle ? now.region(*rectangle).samples : d.extent, request.snap, d.extent);
  if (!request.tolerance_raster.empty()) {
    stages.time("read the tolerances",
                [&] { question.field = tolerance_of_raster(request.tolerance_raster, d, question.region); });
  }
  if (!request.focus.empty()) {
    const Focus focus = parse_focus(request.focus);
    question.field = focus_tolerance(d, focus.x, focus.y, focus.metres_per_metre, question.tolerance);
  }
}

/// An .rqt file holds a quadtree.
void require_fit_for_streams(const Request& request) {
  for (const std::string& output : request.outputs) {
    if (!is_stream_file(output) || parse_border(request.border) != Border::clip) continue;
    throw Failure(
        Cause::invalid_argument,
        fmt::format("--output {}: an .rqt file holds a quadtree, and --border clip cuts its mesh; ask with --border "
                    "cover, or for a mesh",
                    output));
  }
}

/// One word decides about the tolerance, and one about where which is.
void require_tolerance(const Request& request) {
  const bool has_budget = request.budget.vertices > 0 || request.budget.triangles > 0;
  const bool has_raster = !request.tolerance_raster.empty();
  if (int{has_budget} + int{has_raster} + int{!request.tolerance.empty()} != 1) {
    throw Failure(Cause::invalid_argument,
                  "expected --tolerance M, or one of these instead: a budget, --max-vertices or --max-triangles, or "
                  "--tolerance-raster");
  }
  if (has_raster && !request.focus.empty())
    throw Failure(Cause::invalid_argument,
                  "--focus and --tolerance-raster both say where which tolerance is: expected one");
}

/// What whoever asked should know, or do.
std::vector<std::string> remarks_on(const Request& request, const Answer& answer, const Mesh& mesh, bool is_clipped) {
  std::vector<std::string> remarks;
  if (is_clipped) remarks.push_back(clipped_text(request.bbox));
  if (mesh.triangles.empty()) remarks.push_back(why_empty(mesh.region));
  if (!answer.unmatched.empty()) {
    remarks.push_back(
        fmt::format("{} vertices on shared sides are not in the neighbours: ask for those again with --match, or "
                    "there are cracks",
                    counted(answer.unmatched.size())));
  }
  if (answer.void_points > 0) {
    remarks.push_back(fmt::format("{} of the samples that were asked for have no data and are no vertices",
                                  counted(answer.void_points)));
  }
  if (request.outputs.empty()) remarks.push_back("nothing written; add -o FILE to keep the mesh");
  return remarks;
}

Exit run(const Request& request) {
  require_tolerance(request);
  // What is misspelt is said before a file is opened.
  if (!request.tolerance.empty()) static_cast<void>(parse_tolerance(request.tolerance));
  if (!request.focus.empty()) static_cast<void>(parse_focus(request.focus));
  static_cast<void>(parse_border(request.border));
  static_cast<void>(request.heights.heights());
  StreamOptions options = request.stream;
  options.threads = request.threads;
  if (!request.from.empty()) static_cast<void>(parse_tolerance(request.from, "--from"));
  require_fit_for_streams(request);
  std::optional<Rectangle> rectangle;
  if (!request.bbox.empty()) rectangle = parse_bbox(request.bbox);
  check_outputs(request.outputs, inputs_of(request));
  Places places = read_places(request.interest);
  const std::vector<RestrictedQuadtree> neighbours = read_neighbours(request.neighbours);
  Question question = words_of(request, std::move(places), neighbours);
  require_combinable_words(request, question);

  const Snapshot now = open_database(request.database, {.threads = request.threads}).snapshot();
  const Description& description = now.description();
  const bool is_clipped = rectangle && now.region(*rectangle).is_cut;
  const auto start = std::chrono::steady_clock::now();
  Stages stages;
  place(question, request, now, rectangle, stages);
  if (question.from) {
    if (is_clipped) note(clipped_text(request.bbox));
    return write_increment(now, question, request.outputs, options, request.json, request.explain);
  }
  const Answer answer = now.ask(question);
  const bool by_raster = !request.tolerance_raster.empty();
  const Metres tolerance = by_raster        ? Metres{question.field->least(question.region)}
                           : question.field ? question.tolerance
                                            : answer.quadtree.tolerance;
  if (request.tolerance.empty() && !by_raster) stages.add_search(answer.search);
  stages.add(answer.cost);
  Mesh mesh = stages.time("triangulate", [&] { return triangulate(answer.quadtree, request.threads); });
  if (question.border == Border::clip && rectangle)
    mesh = stages.time("cut", [&] { return clip_mesh(mesh, now.region(*rectangle).frame); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  Metres bound = answer.quadtree.bound;
  if (!request.outputs.empty()) {
    stages.time("write",
                [&] { bound = bound + write_outputs(answer.quadtree, mesh, description, request.outputs, options); });
  }

  const std::vector<std::string> remarks = remarks_on(request, answer, mesh, is_clipped);
  notes(remarks);
  if (request.json) {
    Json object{{"region", bounds(description, mesh.region)},
                {"tolerance", tolerance.value},
                {"bound", bound.value},
                {"error_metric", name_of(description.error_metric)},
                {"vertices", mesh.size()},
                {"triangles", mesh.triangles.size()},
                {"quantum", answer.quadtree.origin.quantum.value},
                {"border_vertices", answer.border_vertices},
                {"matching_vertices", answer.matching_vertices},
                {"unmatched_vertices", answer.unmatched.size()},
                {"point_vertices", answer.point_vertices},
                {"void_points", answer.void_points},
                {"pages_read", answer.cost.pages_read},
                {"bytes_read", answer.cost.bytes_read},
                {"seconds", seconds},
                {"output", request.outputs},
                {"notes", remarks}};
    if (rectangle) {
      object["asked"] = Json::array({rectangle->xmin, rectangle->ymin, rectangle->xmax, rectangle->ymax});
      object["clipped"] = is_clipped;
    }
    if (request.explain) object["explain"] = explained(answer.cost, stages);
    print(object);
    return Exit::done;
  }
  Table table;
  table.add("region", bounds_text(description, mesh.region));
  table.add("tolerance", by_raster ? fmt::format("{} or more, by {}", metres(tolerance.value), request.tolerance_raster)
                                   : metres(tolerance.value));
  table.add("bound", bound_text(description, bound));
  if (const std::string why = why_coarser(description, tolerance); !why.empty()) table.add("", why);
  table.add("mesh", fmt::format("{} vertices, {} triangles", counted(mesh.size()), counted(mesh.triangles.size())));
  if (question.heights.kind != HeightKind::exact)
    table.add("heights", fmt::format("multiples of {} m", answer.quadtree.origin.quantum.value));
  table.add("border",
            fmt::format("{}: {} of the vertices are for it alone", request.border, counted(answer.border_vertices)));
  if (!neighbours.empty())
    table.add("match", fmt::format("{} of the vertices are for neighbours alone", counted(answer.matching_vertices)));
  if (!request.interest.is_empty()) {
    table.add("points", fmt::format("{} samples, {} of the vertices are for them alone", counted(answer.points),
                                    counted(answer.point_vertices)));
  }
  table.add("read", fmt::format("{} pages, the header's among them, {}", counted(answer.cost.pages_read),
                                sized(answer.cost.bytes_read)));
  table.add("time", timed(seconds));
  for (const std::string& output : request.outputs) table.add("output", output);
  print(table.text() + (request.explain ? explained_text(answer.cost, stages) : ""));
  return Exit::done;
}

}  // namespace

void add_query(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("query", "Answer a rectangle at a tolerance with a mesh");
  command->add_option("DATABASE", request->database, "Database file")->required()->check(is_named);
  command->add_option("--tolerance", request->tolerance, "Metres, 0 or more, or inf")->option_text("M");
  command->add_option("--from", request->from, "What an answer at this tolerance lacks, as an increment for merge")
      ->option_text("M");
  command->add_option("--bbox", request->bbox, "Rectangle to answer")->option_text("XMIN,YMIN,XMAX,YMAX");
  command
      ->add_option("--border", request->border,
                   "constrain: the rectangle's sides are mesh edges; cover: whole triangles that reach\n"
                   "beyond; clip: those, cut at the rectangle as it was asked for")
      ->option_text("constrain|cover|clip [constrain]");
  command
      ->add_option("--snap", request->snap,
                   "Grow the rectangle to multiples of N samples; 16 needs fewest border vertices")
      ->transform(whole())
      ->option_text("N [1]");
  command
      ->add_option("--max-level", request->max_level,
                   "No vertex finer than this level, 0 the coarsest, whatever the tolerance; the bound says what\n"
                   "is kept")
      ->transform(whole())
      ->check(CLI::Range(0, 31))
      ->option_text("L");
  command
      ->add_option("--max-vertices", request->budget.vertices,
                   "Instead of a tolerance: the smallest whose answer has at most N, on the ladder of stored errors,\n"
                   "whose rungs are 0.6 % apart. Beside voids vertices count that no triangle needs")
      ->transform(whole())
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 62))
      ->option_text("N");
  command->add_option("--max-triangles", request->budget.triangles, "The same for triangles")
      ->transform(whole())
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 62))
      ->option_text("N");
  command
      ->add_option("--focus", request->focus,
                   "The tolerance is that of --tolerance at a point and grows by so many metres with each metre\n"
                   "on the ground from it")
      ->option_text("X,Y,METRES_PER_METRE");
  command
      ->add_option("--tolerance-raster", request->tolerance_raster,
                   "Instead of a tolerance: a raster of one band with metres. Each sample has the tolerance of\n"
                   "the cell it lies in, at most 1000000; one that is not georeferenced lies evenly over the\n"
                   "rectangle")
      ->option_text("FILE")
      ->check(is_named);
  add_interest(command, request->interest);
  command
      ->add_option("--match", request->neighbours,
                   "An answer of another rectangle with the same side, or part of one: its vertices there\n"
                   "become vertices here, so that the two meet at any tolerances. Ask for the finer one\n"
                   "first: what a coarser neighbour lacks is counted, and there the two do not meet. Repeat it\n"
                   "for more neighbours than one")
      ->option_text("NEIGHBOUR.rqt ...")
      ->check(is_named)
      ->type_size(1)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      ->add_option("-o,--output", request->outputs,
                   "Write the mesh; the ending says how: .ply (binary, double x y z), .obj, .glb (glTF, in\n"
                   "metres), .tif (heights at the samples), .png (a picture), or .rqt: the quadtree itself,\n"
                   "for merge and convert. Repeat it for more than one; an existing file is replaced")
      ->option_text("OUT ...")
      ->check(is_named)
      ->type_size(1)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_height_words(command, request->heights);
  add_stream_words(command, request->stream);
  command->add_flag("--explain", request->explain,
                    "Print also which pages were read, which were left out and why, and where time went");
  command->add_option("--threads", request->threads, "Of a large answer; changes nothing but the time; 0: one a core")
      ->transform(whole())
      ->check(CLI::Range(0, 1024))
      ->option_text("N [0]");
  command->add_flag("--json", request->json, "Print one JSON object");
  command->footer(
      "\n"
      "Answer a rectangle at a tolerance with a crack-free mesh: every valid sample of the rectangle under it lies\n"
      "within the tolerance of its surface. Answers at one tolerance for rectangles that share a whole side meet\n"
      "without a crack if both are at least 16 cells deep across it.\n"
      "\n"
      "The rectangle is in the database's CRS, X before Y, and goes outward to the next samples, which are\n"
      "pixel centres; without one the whole raster is answered. Tolerance and bound are metres, heights go\n"
      "out in the source's vertical unit. Of longitudes, XMIN above XMAX is the box across the antimeridian.\n"
      "\n"
      "Points and lines are in the database's CRS, within the rectangle. Samples nearest to them become vertices; "
      "those\n"
      "without data do not, and are counted. The edges of the mesh need not follow a line. A raster of tolerances "
      "must\n"
      "cover the rectangle and be in the database's CRS; a cell in which a sample lies must not be void or negative.\n"
      "\nExample:\n"
      "  talus query alps.talus --tolerance 2 --bbox=7.5,45.9,7.8,46.1 -o matterhorn.ply -o matterhorn.png\n"
      "  talus query alps.talus --max-triangles 100000 -o overview.ply\n"
      "  talus query alps.talus --tolerance 0.5 --focus=7.66,45.98,0.01 -o view.ply\n"
      "  talus query alps.talus --tolerance 20 --point=7.66,45.98 --lines roads.txt -o roads.ply\n"
      "  talus query alps.talus --tolerance 2 --explain\n"
      "  talus query alps.talus --tolerance 1 --bbox=7.5,45.9,7.7,46.1 -o west.ply -o west.rqt\n"
      "  talus query alps.talus --tolerance 20 --bbox=7.7,45.9,7.9,46.1 --match west.rqt -o east.ply");
  command->callback([request, &action] { action = [request] { return run(*request); }; });
}

}  // namespace talus::app
