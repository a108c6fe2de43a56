// talus help: the help of a command, and pages on what no single command owns.

#include "app/terminal/help.hpp"

#include "app/commands/commands.hpp"
#include "app/terminal/report.hpp"

namespace talus::app {
namespace {

struct Topic {
  const char *name, *summary, *text;
};

constexpr Topic kTopics[] = {
    {"tolerance", "what a tolerance promises, and how to choose one",
     R"(The tolerance is a distance in metres. Talus makes a mesh such that every sample under it lies within the tolerance of its surface, measured along the vertical. A sample is not under the mesh where voids leave it too few neighbours for a triangle; talus verify counts these as stray.

A larger tolerance gives fewer triangles and a faster answer:
  0      every sample lies exactly on the surface
  2      every sample lies within 2 m
  inf    the coarsest mesh there is

The bound is what an answer keeps. It is at most the tolerance (plus some nanometres where heights are decimal fractions), except where ingest rounded heights (--height-step) or kept fewer vertices (--tolerance), and where --max-level leaves out fine levels. A database made with --metric perpendicular measures at right angles to the triangles.

Other ways to say how exact an answer is:
  --max-triangles N     the smallest tolerance whose mesh has at most N triangles; N may be 1e5, 100k or 2.5M
  --focus X,Y,M         exact at a point, coarser with the distance from it
  --tolerance-raster F  a tolerance for each cell of a raster

To choose one, measure what each costs:
  talus accuracy alps.talus)"},
    {"places", "points, lines, rectangles, longitudes",
     R"(Places are in the CRS of the database, X before Y: longitude before latitude, easting before northing. talus info shows the CRS and the rectangle of a database.
  point      X,Y
  line       X,Y,X,Y,... straight between its points
  rectangle  XMIN,YMIN,XMAX,YMAX

Commas or blanks separate the numbers: --bbox=7.5,45.9,7.8,46.1 and --bbox 7.5 45.9 7.8 46.1 are the same. Negative numbers need no quotes.

Samples are pixel centres. A rectangle grows outward to the next samples. Where it reaches beyond the raster it is cut, and a note says so.

Longitudes that differ by 360 are one place: 181 is -179. A rectangle with XMIN above XMAX crosses the antimeridian. A line takes the short way.

In a raster without a CRS, a cell is one metre.)"},
    {"outputs", "file formats, by the ending of -o",
     R"(The ending of -o chooses the format:
  .ply   the mesh, binary, X, Y and Z as doubles
  .obj   the mesh as text
  .glb   the mesh as glTF, in metres, for any CRS
  .tif   the heights of the surface at all samples
  .png   a picture: shaded relief with the triangles over it
  .rqt   the answer itself, see talus help streams
  .csv   the heights along a line (talus profile)
  .html  a report: advice, curves, maps and a table (talus accuracy)
  .svg   the same without the table

Repeat -o to write several files. An existing file is replaced, but never one that the same command reads. A file appears whole or not at all.

In a CRS with degrees, .ply and .obj have X and Y in degrees and Z in the unit of the heights. Viewers then show needles: use .glb, or ingest with --t-srs and a CRS in metres.)"},
    {"streams", ".rqt files: answers and increments",
     R"(An .rqt file holds an answer: the vertices of a mesh, coarse ones first, in few bytes. A reader can stop after each part and has a mesh with a known bound. talus info shows the parts.
  talus query alps.talus --tolerance 20 -o coarse.rqt
  talus convert coarse.rqt -o coarse.ply

An increment holds only what a finer answer has in addition. It fits one answer: the one of the same database and rectangle whose tolerance is --from, with --border constrain.
  talus query alps.talus --from 20 --tolerance 2 -o more.rqt
  talus merge coarse.rqt more.rqt -o fine.rqt

The result is the answer at 2 m, bit for bit. --heights bounded makes .rqt files smaller; with the same --quantum, increments fit too.

Neighbouring rectangles at one tolerance meet without cracks. At different tolerances, --match takes the vertices on the shared side from the neighbour.)"},
    {"voids", "samples without data",
     R"(A void is a sample without a height: nodata, a mask, alpha 0 or NaN. At fine tolerances no triangle covers a void. At coarse ones a triangle may reach over one, by at most the tolerance divided by the void weight, and a small void can vanish. The bound holds for samples, not for voids.

Where files do not declare their nodata value, name it:
  talus ingest tiles/ land.talus --nodata -9999

--void-weight says how closely the edge of a mesh follows the outline of the data. talus height prints "void" at a void, and "outside" beyond the raster.)"},
    {"json", "output for programs",
     R"(With --json, standard output holds one JSON object and nothing else; talus height prints one object for each point. Numbers have all digits.

A failure is an object too, on one line:
  {"failure":{"cause":"not_found","exit_code":1,"file":"a.talus","message":"..."}}

"file" is null when no file is at fault. The causes are invalid_argument, not_found, corrupt, unsupported, full, io, cancelled, too_large, out_of_memory, interrupted and unexpected.

Standard error has the same sentence. Notes are lines on standard error that begin with "talus: note:".)"},
    {"exit-codes", "what the exit code of each command means",
     R"(  0    done
  1    failed: a file is missing, cannot be read, or is not supported
  2    wrong usage, or an argument that is not valid
  3    a file is damaged, or is not what it should be
  4    the disk is full
  5    a database differs from its source, or a sample lies beyond a bound
  130  interrupted: Ctrl-C, or a closed terminal

Standard error has one sentence: what is wrong, and what to do. After a failure no half-written file is left, except the .part file of talus ingest, which --resume continues.)"},
};

struct Request {
  std::string word;
  const CLI::App* program = nullptr;
  bool json = false;
};

Exit run(Request& request) {
  if (request.word.empty()) {
    print(request.program->get_formatter()->make_help(request.program, "talus", CLI::AppFormatMode::Normal));
    return Exit::done;
  }
  std::vector<std::string> commands, names;
  for (const CLI::App* command : request.program->get_subcommands({})) {
    if (command->get_name() == request.word) {
      print(command->help("talus"));
      return Exit::done;
    }
    commands.push_back(command->get_name());
  }
  for (const Topic& topic : kTopics) {
    if (topic.name == request.word) {
      print(folded(topic.text, help_width()));
      return Exit::done;
    }
    names.emplace_back(topic.name);
  }
  const std::string topics = listed(names);
  names.insert(names.end(), commands.begin(), commands.end());
  throw Failure(Cause::invalid_argument, fmt::format("there is no help on {}; the topics are {}{}", request.word,
                                                     topics, did_you_mean(request.word, names)));
}

}  // namespace

void add_help(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  request->program = &program;
  Command command(program, "help", "Explain a command or a topic");
  command.group("Arguments").option("WORD", request->word, "COMMAND|TOPIC", "A command, or one of the topics below");
  command.finish(action, request, run, topics(), "Print a failure as one JSON object");
}

std::string topics() {
  std::string text = "Topics:\n";
  for (const Topic& topic : kTopics) text += fmt::format("  {:<20}  {}\n", topic.name, topic.summary);
  text.pop_back();
  return text;
}

}  // namespace talus::app
