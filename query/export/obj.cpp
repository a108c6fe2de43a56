#include <cstdint>
#include <iterator>

#include <fmt/format.h>

#include "query/export/writers.hpp"

namespace talus {

void write_obj(const Mesh& mesh, const Description& description, OutputFile& out) {
  out.write("# Talus\n");
  fmt::memory_buffer line;
  const auto put = [&] {
    out.write({line.data(), line.size()});
    line.clear();
  };
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    fmt::format_to(std::back_inserter(line), "v {} {} {}\n", description.mapping.x(mesh.place(i).col),
                   description.mapping.y(mesh.place(i).row), mesh.heights[i]);
    put();
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    fmt::format_to(std::back_inserter(line), "f {} {} {}\n", std::uint64_t{a} + 1, std::uint64_t{b} + 1,
                   std::uint64_t{c} + 1);
    put();
  }
}

}  // namespace talus
