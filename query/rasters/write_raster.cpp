#include <array>
#include <string>
#include <string_view>

#include "engine/machine/fail.hpp"
#include "query/export/writers.hpp"
#include "query/rasters/raster_writers.hpp"
#include "talus/raster_output.hpp"

namespace talus {
namespace {

struct Format {
  std::string_view ending;
  void (*write)(const Mesh&, const Description&, OutputFile&);
};

constexpr std::array<Format, 2> kFormats{{{".tif", write_tif}, {".png", write_png}}};

const Format* format_of(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  for (const Format& format : kFormats) {
    if (format.ending == ending) return &format;
  }
  return nullptr;
}

}  // namespace

bool is_raster_file(const std::filesystem::path& file) { return format_of(file) != nullptr; }

void write_raster(const Mesh& mesh, const Description& description, const std::filesystem::path& file) {
  blaming(file, [&] {
    const Format* format = format_of(file);
    if (format == nullptr) refuse("cannot write a raster to {}: the name must end in .tif or .png", file.string());
    check_mesh(mesh, file);
    OutputFile out{file};
    format->write(mesh, description, out);
    out.commit();
  });
}

}  // namespace talus
