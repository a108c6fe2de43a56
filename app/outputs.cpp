#include "app/outputs.hpp"

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

void write_outputs(const RestrictedQuadtree& answer, const Mesh& mesh, const Description& description,
                   const std::vector<std::string>& outputs, const StreamOptions& options) {
  for (const std::string& output : outputs) {
    const HoldInterrupts whole_file_or_none;
    if (is_stream_file(output)) {
      write_stream({description, answer}, output, options);
    } else {
      write_mesh(mesh, description, output);
    }
  }
}

}  // namespace talus::app
