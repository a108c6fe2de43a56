// Talus inside another program: a raster in, a mesh out.

#include <cstdio>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "usage: embed RASTER DATABASE OUT.ply\n");
    return 2;
  }
  talus::IngestOptions options;
  options.overwrite = true;
  talus::ingest(argv[1], argv[2], options);
  const auto now = talus::Database::open(argv[2]).snapshot();
  const auto mesh = now.mesh(talus::Metres{5});  // no sample is farther than 5 m from it
  talus::write_mesh(mesh, now.description(), argv[3]);
  std::printf("%zu vertices, %zu triangles\n", mesh.points.size(), mesh.triangles.size());
} catch (const talus::Failure& failure) {
  std::fprintf(stderr, "%s\n", failure.what());
  return 1;
}
