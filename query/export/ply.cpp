#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "query/export/writers.hpp"

namespace talus {

void write_ply(const Mesh& mesh, const Description& description, OutputFile& out) {
  if (mesh.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    fail(Cause::unsupported,
         "a PLY file has at most {} vertices, but the mesh has {}. Ask for a smaller rectangle or a larger tolerance",
         std::numeric_limits<std::int32_t>::max(), mesh.size());
  }
  out.write(
      fmt::format("ply\n"
                  "format binary_little_endian 1.0\n"
                  "comment Talus\n"
                  "element vertex {}\n"
                  "property double x\n"
                  "property double y\n"
                  "property double z\n"
                  "element face {}\n"
                  "property list uchar int vertex_indices\n"
                  "end_header\n",
                  mesh.size(), mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    out.write_little_endian(description.mapping.x(mesh.place(i).col));
    out.write_little_endian(description.mapping.y(mesh.place(i).row));
    out.write_little_endian(mesh.heights[i]);
  }
  for (const auto& triangle : mesh.triangles) {
    out.write_little_endian(std::uint8_t{3});
    for (const std::uint32_t id : triangle) out.write_little_endian(id);
  }
}

}  // namespace talus
