// talus merge and talus convert: what becomes of .rqt files.

#include <cerrno>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/options/arguments.hpp"
#include "app/options/outputs.hpp"
#include "app/options/stream_answer.hpp"
#include "app/options/stream_options.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
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

/// At most as many bytes as there is room for, as soon as there are some; 0 at the end.
std::size_t read_some(std::span<std::byte> room) {
  for (;;) {
    const ssize_t count = ::read(STDIN_FILENO, room.data(), room.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR)
      throw Failure(Cause::io, fmt::format("cannot read the standard input: {}", std::strerror(errno)));
  }
}

/// The mesh is made if a file or a reader wants it.
Exit report(const RestrictedQuadtree& answer, const Description& description, const Request& request) {
  const Mesh mesh = triangulate(answer, request.threads);
  StreamOptions options = request.stream;
  options.threads = request.threads;
  const Metres bound = answer.bound + write_outputs(answer, mesh, description, request.outputs, options);
  if (request.json) {
    print(Json{{"region", bounds(description, answer.region)},
               {"tolerance", answer.tolerance.value},
               {"bound", bound.value},
               {"error_metric", name_of(description.error_metric)},
               {"vertices", mesh.size()},
               {"triangles", mesh.triangles.size()},
               {"output", request.outputs}});
    return Exit::done;
  }
  Table table;
  table.add("region", bounds_text(description, answer.region));
  table.add("tolerance", metres(answer.tolerance.value));
  table.add("bound", bound_text(description, bound));
  table.add("mesh", fmt::format("{} vertices, {} triangles", counted(mesh.size()), counted(mesh.triangles.size())));
  for (const std::string& output : request.outputs) table.add("output", output);
  print(table);
  return Exit::done;
}

/// "coarse.rqt", or what it and increments so far have made.
std::string made_of(const std::vector<std::string>& inputs, std::size_t count) {
  if (count == 1) return inputs.front();
  return fmt::format("{} merged with {}", inputs.front(),
                     fmt::join(inputs.begin() + 1, inputs.begin() + static_cast<std::ptrdiff_t>(count), ", "));
}

/// An increment that goes on from something else is at fault, and so is one out of its turn. The sentence says what
/// stands before it.
RestrictedQuadtree merged(const RestrictedQuadtree& answer, const Request& request, std::size_t i) {
  const std::string& file = request.inputs[i];
  try {
    const Stream delta = read_stream(file, {}, &answer, request.threads);
    const auto* increment = std::get_if<Increment>(&delta.content);
    if (increment == nullptr) {
      throw Failure(
          Cause::invalid_argument,
          fmt::format("{} is an answer and no increment: the first file is an answer, all others are increments, "
                      "which talus query --from writes",
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
    throw Failure(failure.cause(), fmt::format("{}; the answer here is {}", failure.what(), made_of(request.inputs, i)),
                  file);
  }
}

Exit run_merge(const Request& request) {
  check_outputs(request.outputs, request.inputs);
  for (const std::string& file : request.inputs) require_stream(file);
  const std::string& first = request.inputs.front();
  Stream base = read_stream(first, {}, nullptr, request.threads);
  RestrictedQuadtree answer = answer_of(base, first);
  if (request.inputs.size() > 1 && !answer.origin.is_plain) {
    throw Failure(
        Cause::invalid_argument,
        fmt::format("no increment goes on from {}: that takes a whole answer of a rectangle at one tolerance, with "
                    "--border constrain and exact heights or a --quantum",
                    first),
        first);
  }
  for (std::size_t i = 1; i < request.inputs.size(); ++i) answer = merged(answer, request, i);
  return report(answer, base.description, request);
}

/// What has arrived of a stream is told as soon as it is a quadtree with a bound.
Stream read_standard_input(const Request& request) {
  StreamDecoder decoder({}, nullptr, request.threads);
  std::vector<std::byte> room(1 << 16);
  std::size_t told = 0;
  while (const std::size_t count = read_some(room)) {
    decoder.add(std::span(room).first(count));
    if (decoder.parts() == told) continue;
    told = decoder.parts();
    write_to_log(fmt::format("part {} of {}: {} vertices, bound {}\n", told, decoder.parts_in_all(),
                             counted(decoder.vertices()), metres(decoder.bound().value)));
  }
  decoder.require_whole();
  return decoder.stream();
}

Exit run_convert(const Request& request) {
  check_outputs(request.outputs, request.inputs);
  const std::string& input = request.inputs.front();
  if (input != "-") require_stream(input);
  Stream stream = input == "-" ? read_standard_input(request) : read_stream(input, {}, nullptr, request.threads);
  return report(answer_of(stream, input), stream.description, request);
}

void add_output(CLI::App* command, Request& request) {
  command
      ->add_option(
          "-o,--output", request.outputs,
          "The ending says what: .ply, .obj, .glb, .tif, .png or .rqt. Repeat it for more than one; an existing\n"
          "file is replaced")
      ->option_text("OUT ... REQUIRED")
      ->required()
      ->check(is_named)
      ->type_size(1)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_stream_words(command, request.stream);
  command
      ->add_option("--threads", request.threads,
                   "To read and to write with; changes nothing but the time; 0: one a core")
      ->transform(whole())
      ->check(CLI::Range(0, 1024))
      ->option_text("N [0]");
  command->add_flag("--json", request.json, "Print one JSON object");
}

}  // namespace

void add_merge(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("merge", "Make an answer finer with increments");
  command
      ->add_option("BASE.rqt DELTA.rqt", request->inputs,
                   "An answer, then increments, each going on from the one before")
      ->option_text("... REQUIRED")
      ->required()
      ->check(is_named);
  add_output(command, *request);
  command->footer(
      "\n"
      "The result is the answer that query gives at the last increment's tolerance, bit for bit.\n"
      "\nExample:\n"
      "  talus query alps.talus --tolerance 20 -o coarse.rqt\n"
      "  talus query alps.talus --from 20 --tolerance 2 -o more.rqt\n"
      "  talus merge coarse.rqt more.rqt -o fine.rqt");
  command->callback([request, &action] { action = [request] { return run_merge(*request); }; });
}

void add_convert(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("convert", "Make a mesh file of an answer in an .rqt file");
  command
      ->add_option("IN.rqt", request->inputs, "An answer; -: the standard input, whose levels are told as they arrive")
      ->option_text("REQUIRED")
      ->required()
      ->expected(1)
      ->check(is_named);
  add_output(command, *request);
  command->footer("\nExample:\n  talus convert fine.rqt -o fine.ply");
  command->callback([request, &action] { action = [request] { return run_convert(*request); }; });
}

}  // namespace talus::app
