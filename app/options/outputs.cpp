#include "app/options/outputs.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "app/options/arguments.hpp"
#include "app/terminal/interrupt.hpp"
#include "query/export/output_file.hpp"
#include "query/export/writers.hpp"
#include "talus/failure.hpp"
#include "talus/raster_output.hpp"

namespace talus::app {

void require_no_input(const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code ignored;
    if (input == "-" || input.starts_with('@') || !std::filesystem::equivalent(output, input, ignored)) continue;
    const std::string what = output == input ? "is an input" : fmt::format("is the same file as the input {}", input);
    throw Failure(Cause::invalid_argument,
                  fmt::format("--output {} {}, which would be lost; name another file", output, what), output);
  }
}

void require_ending(const std::string& output, const char* what, const std::vector<std::string>& endings) {
  const auto ends = [&](const std::string& ending) { return output.ends_with(ending); };
  if (std::any_of(endings.begin(), endings.end(), ends)) return;
  throw Failure(Cause::invalid_argument,
                fmt::format("--output {}: the name of {} must end in {}", output, what, listed(endings, "or")), output);
}

void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  for (const std::string& output : outputs) {
    require_no_input(output, inputs);
    if (!is_stream_file(output) && !is_raster_file(output) && !is_mesh_file(output))
      require_ending(output, "an answer", {".ply", ".obj", ".glb", ".tif", ".png", ".rqt"});
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

void write_text(const std::string& output, const std::string& text) {
  const HoldInterrupts whole_file_or_none;
  OutputFile file(output);
  file.write(text);
  file.commit();
}

}  // namespace talus::app
