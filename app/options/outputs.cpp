#include "app/options/outputs.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "app/terminal/interrupt.hpp"
#include "query/export/writers.hpp"
#include "talus/failure.hpp"
#include "talus/raster_output.hpp"

namespace talus::app {

void require_no_input(const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code ignored;
    if (input == "-" || input.starts_with('@') || !std::filesystem::equivalent(output, input, ignored)) continue;
    const std::string what = output == input
                                 ? "is an input, too, and would be lost"
                                 : fmt::format("is the same file as the input {}, which would be lost", input);
    throw Failure(Cause::invalid_argument, fmt::format("--output {} {}; name another file", output, what), output);
  }
}

namespace {

void require_known_ending(const std::string& output) {
  if (is_stream_file(output) || is_raster_file(output) || is_mesh_file(output)) return;
  throw Failure(
      Cause::invalid_argument,
      fmt::format("cannot tell what to write to {}: the name must end in .ply, .obj, .glb, .tif, .png or .rqt", output),
      output);
}

}  // namespace

void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  for (const std::string& output : outputs) {
    require_no_input(output, inputs);
    require_known_ending(output);
    check_folder(output);
  }
}

Metres write_outputs(const RestrictedQuadtree& answer, const Mesh& mesh, const Description& description,
                     const std::vector<std::string>& outputs, const StreamOptions& options) {
  Metres rounding{0};
  for (const std::string& output : outputs) {
    const HoldInterrupts whole_file_or_none;
    if (is_stream_file(output)) {
      write_stream({description, answer}, output, options);
    } else if (is_raster_file(output)) {
      write_raster(mesh, description, output);
    } else {
      rounding = std::max(rounding, write_mesh(mesh, description, output));
    }
  }
  return rounding;
}

}  // namespace talus::app
