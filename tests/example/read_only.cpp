// A program that only reads: it links talus::read, and so neither GDAL nor PROJ.

#include <cstdio>

#include "talus/talus.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: read_only DATABASE OUT.ply\n", stderr);
    return 2;
  }
  try {
    const auto now = talus::Database::open(argv[1]).snapshot();
    const talus::Mesh mesh = now.mesh(talus::Metres{20});
    talus::write_mesh(mesh, now.description(), argv[2]);
    std::printf("%s, EPSG:%d: %zu triangles\n", now.description().crs.name.c_str(), now.description().crs.epsg,
                mesh.triangles.size());
  } catch (const talus::Failure& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 1;
  }
}
