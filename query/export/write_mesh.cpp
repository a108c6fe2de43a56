#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

#include "engine/machine/fail.hpp"
#include "query/export/writers.hpp"
#include "talus/database.hpp"

namespace talus {
namespace {

struct Format {
  std::string_view ending;
  Metres (*write)(const Mesh&, const Description&, OutputFile&);
};

/// A writer of a format that rounds nothing.
template <void (*Write)(const Mesh&, const Description&, OutputFile&)>
Metres exactly(const Mesh& mesh, const Description& description, OutputFile& out) {
  Write(mesh, description, out);
  return Metres{0};
}

constexpr std::array<Format, 3> kFormats{
    {{".ply", exactly<write_ply>}, {".obj", exactly<write_obj>}, {".glb", write_glb}}};

const Format* known_format(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  for (const Format& format : kFormats) {
    if (format.ending == ending) return &format;
  }
  return nullptr;
}

const Format& format_of(const std::filesystem::path& file) {
  if (const Format* format = known_format(file)) return *format;
  refuse(
      "cannot write a mesh to {}: the name must end in .ply, .obj or .glb (write_raster writes .tif and .png, "
      "write_stream .rqt)",
      file.string());
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& file) { return known_format(file) != nullptr; }

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

void check_mesh(const Mesh& mesh, const std::filesystem::path& file) {
  const std::size_t points = mesh.size();
  if (mesh.heights.size() != points) {
    refuse("cannot write {}: the mesh has {} points and {} heights; each point needs one", file.string(), points,
           mesh.heights.size());
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t id : mesh.triangles[i]) {
      if (id < points) continue;
      refuse("cannot write {}: triangle {} of the mesh names point {}; there are {}, counted from 0", file.string(), i,
             id, points);
    }
  }
}

void check_folder(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored))
    fail_in(file, Cause::io, "cannot write {}: there is no folder {}", file.string(), folder.string());
  if (std::filesystem::is_directory(file, ignored))
    fail_in(file, Cause::io, "cannot write {}: it is a folder", file.string());
}

Metres write_mesh(const Mesh& mesh, const Description& description, const std::filesystem::path& file) {
  return within_memory([&] {
    return blaming(file, [&] {
      const Format& format = format_of(file);
      check_mesh(mesh, file);
      OutputFile out{file};
      const Metres rounding = format.write(mesh, description, out);
      out.commit();
      return rounding;
    });
  });
}

}  // namespace talus
