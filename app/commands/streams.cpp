// talus merge and talus convert: from .rqt files to others.

#include <span>
#include <string_view>
#include <variant>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/options/outputs.hpp"
#include "app/options/shared_options.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
#include "app/terminal/standard_files.hpp"
#include "talus/database.hpp"
#include "talus/stream.hpp"

namespace talus::app {
namespace {

struct Request {
  std::vector<std::string> inputs, outputs;
  StreamOptions stream;
  int threads = 0;
  bool json = false;
};

StreamOptions stream_options(const Request& request) {
  StreamOptions options = request.stream;
  options.threads = request.threads;
  return options;
}

Exit report(const RestrictedQuadtree& answer, const Description& description, const Request& request) {
  const Mesh mesh = triangulate(answer, request.threads);
  const Metres bound =
      answer.bound + write_outputs(answer, mesh, description, request.outputs, stream_options(request));
  if (request.json) {
    Json object{{"region", bounds(description, answer.region)}};
    add_bound(object, description, answer.tolerance, bound);
    object.update({{"vertices", mesh.size()}, {"triangles", mesh.triangles.size()}, {"output", request.outputs}});
    print(object);
    return Exit::done;
  }
  Table table;
  table.add("region", bounds_text(description, answer.region));
  add_bound(table, description, answer.tolerance, bound);
  table.add("mesh", mesh_text(mesh.size(), mesh.triangles.size()));
  for (const std::string& output : request.outputs) table.add("output", output);
  print(table);
  return Exit::done;
}

/// "coarse.rqt", or "coarse.rqt merged with 1.rqt, 2.rqt".
std::string made_of(const std::vector<std::string>& inputs, std::size_t count) {
  if (count == 1) return inputs.front();
  return fmt::format("{} merged with {}", inputs.front(),
                     fmt::join(inputs.begin() + 1, inputs.begin() + static_cast<std::ptrdiff_t>(count), ", "));
}

/// Blames an increment that does not fit, and says what stands before it.
RestrictedQuadtree merged(const RestrictedQuadtree& answer, const Request& request, std::size_t i) {
  const std::string& file = request.inputs[i];
  try {
    const Stream delta = read_stream(file, {}, &answer, request.threads);
    const auto* increment = std::get_if<Increment>(&delta.content);
    if (increment == nullptr) {
      throw Failure(Cause::invalid_argument,
                    fmt::format("{} is an answer; only the first file may be one, the others must be increments, which "
                                "talus query --from writes",
                                file),
                    file);
    }
    try {
      return merge(answer, *increment);
    } catch (const Failure& failure) {
      throw Failure(failure.cause(), fmt::format("{}: {}", file, failure.what()), file);
    }
  } catch (const Failure& failure) {
    const bool is_misfit =
        failure.cause() == Cause::invalid_argument && std::string_view(failure.what()).starts_with(file + ":");
    if (!is_misfit) throw;
    throw Failure(failure.cause(),
                  fmt::format("{}; the answer before it is {}", failure.what(), made_of(request.inputs, i)), file);
  }
}

Exit run_merge(Request& request) {
  check_outputs(request.outputs, request.inputs);
  for (const std::string& file : request.inputs) require_stream(file);
  const std::string& first = request.inputs.front();
  Stream base = read_stream(first, {}, nullptr, request.threads);
  RestrictedQuadtree answer = answer_of(base, first);
  if (request.inputs.size() > 1 && !answer.origin.is_plain) {
    throw Failure(
        Cause::invalid_argument,
        fmt::format("{}: no increment fits; ask for the answer again with one tolerance, --border constrain, and "
                    "exact heights or a --quantum",
                    first),
        first);
  }
  for (std::size_t i = 1; i < request.inputs.size(); ++i) answer = merged(answer, request, i);
  return report(answer, base.description, request);
}

/// Reports each part with its bound as soon as it has arrived.
Stream stream_of_standard_input(const Request& request) {
  StreamDecoder decoder({}, nullptr, request.threads);
  std::vector<std::byte> room(1 << 16);
  std::size_t reported = 0;
  while (const std::size_t count = read_standard_input(room)) {
    decoder.add(std::span(room).first(count));
    if (decoder.parts() == reported) continue;
    reported = decoder.parts();
    write_to_log(fmt::format("part {} of {}: {} vertices, bound {}\n", reported, decoder.parts_in_all(),
                             counted(decoder.vertices()), metres(decoder.bound().value)));
  }
  decoder.require_whole();
  return decoder.stream();
}

Exit run_convert(Request& request) {
  check_outputs(request.outputs, request.inputs);
  const std::string& input = request.inputs.front();
  if (input != "-") require_stream(input);
  Stream stream = input == "-" ? stream_of_standard_input(request) : read_stream(input, {}, nullptr, request.threads);
  return report(answer_of(stream, input), stream.description, request);
}

void add_options(Command& command, const std::shared_ptr<Request>& request) {
  command.group("Most used")
      .files("-o,--output", request->outputs, "OUT",
             "File to write; the ending is the format: .ply, .obj, .glb, .tif, .png or .rqt. Can "
             "be repeated")
      ->required();
  add_stream_options(command.group("Writing .rqt files"), request->stream);
  command.group("Other").threads(request->threads);
}

}  // namespace

void add_merge(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  Command command(program, "merge", "Make an answer finer with increments");
  command.group("Arguments")
      .file("BASE.rqt DELTA.rqt...", request->inputs, "BASE.rqt DELTA.rqt...",
            "An answer, then increments. Each fits what the files before it make")
      ->required();
  add_options(command, request);
  command.finish(action, request, run_merge,
                 "The result is the answer that talus query gives at the tolerance of the last increment, bit for bit. "
                 "talus help streams explains .rqt files.\n"
                 "\nExample:\n"
                 "  talus query alps.talus --tolerance 20 -o coarse.rqt\n"
                 "  talus query alps.talus --from 20 --tolerance 2 -o more.rqt\n"
                 "  talus merge coarse.rqt more.rqt -o fine.rqt");
}

void add_convert(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  Command command(program, "convert", "Write an answer in an .rqt file as a mesh");
  command.group("Arguments")
      .file("IN.rqt", request->inputs, "IN.rqt",
            "An answer, or - for standard input. From there, each part is reported when it arrives")
      ->required()
      ->expected(1);
  add_options(command, request);
  command.finish(action, request, run_convert,
                 "talus help streams explains .rqt files.\n"
                 "\nExample:\n  talus convert fine.rqt -o fine.ply");
}

}  // namespace talus::app
