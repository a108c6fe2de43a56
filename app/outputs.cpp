#include "app/outputs.hpp"

#include <algorithm>

#include "app/interrupt.hpp"
#include "query/export/writers.hpp"

namespace talus::app {

void check_outputs(const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs) {
    if (is_stream_file(output)) {
      check_folder(output);
    } else {
      check_mesh_file(output);
    }
  }
}

Metres write_outputs(const RestrictedQuadtree& answer, const Mesh& mesh, const Description& description,
                     const std::vector<std::string>& outputs, const StreamOptions& options) {
  Metres rounding{0};
  for (const std::string& output : outputs) {
    const HoldInterrupts whole_file_or_none;
    if (is_stream_file(output)) {
      write_stream({description, answer}, output, options);
    } else {
      rounding = std::max(rounding, write_mesh(mesh, description, output));
    }
  }
  return rounding;
}

}  // namespace talus::app
