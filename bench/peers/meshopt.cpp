// Bytes of a mesh as meshoptimizer codes it: what streams.py compares with.
//
//   meshopt MESH.ply     binary, float x, y, z that are whole numbers of 0 to 65535, then triangles: as streams.py
//   writes it
//
// Triangles and vertices are put into the order that its coders want; positions take 16 bits each, so nothing is lost.
// Prints the bytes of indices and vertices, and of both behind zstd at level 19, as its authors advise.

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <meshoptimizer.h>
#include <zstd.h>

namespace {

struct Position {
  std::uint16_t x, y, z, unused;
};

struct PlyMesh {
  std::vector<Position> vertices;
  std::vector<unsigned> indices;
};

std::size_t count_of(const std::string& head, const std::string& element) {
  const std::size_t at = head.find("element " + element + " ");
  if (at == std::string::npos) throw std::runtime_error("no element " + element);
  return std::stoul(head.substr(at + 9 + element.size()));
}

PlyMesh read_ply(const char* file) {
  std::ifstream in(file, std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(in), {}};
  const std::size_t end = all.find("end_header\n");
  if (end == std::string::npos) throw std::runtime_error(std::string(file) + " is not a PLY file");
  const std::string head = all.substr(0, end);
  PlyMesh mesh;
  mesh.vertices.resize(count_of(head, "vertex"));
  const std::size_t triangles = count_of(head, "face");
  const std::size_t start = end + 11;
  if (all.size() != start + 12 * mesh.vertices.size() + 13 * triangles)
    throw std::runtime_error("another size than the header says");
  const char* at = all.data() + start;
  for (Position& p : mesh.vertices) {
    float xyz[3];
    std::memcpy(xyz, at, 12);
    at += 12;
    for (const float v : xyz) {
      if (!(v >= 0 && v <= 65535)) throw std::runtime_error("a coordinate beyond 16 bits");
    }
    p = {static_cast<std::uint16_t>(xyz[0]), static_cast<std::uint16_t>(xyz[1]), static_cast<std::uint16_t>(xyz[2]), 0};
  }
  mesh.indices.resize(3 * triangles);
  for (std::size_t t = 0; t < triangles; ++t, at += 13) std::memcpy(&mesh.indices[3 * t], at + 1, 12);
  return mesh;
}

std::size_t packed(const std::vector<unsigned char>& bytes) {
  std::vector<char> out(ZSTD_compressBound(bytes.size()));
  return ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 19);
}

}  // namespace

int main(int count, char** words) try {
  if (count != 2) {
    std::fputs("meshopt MESH.ply\n", stderr);
    return 2;
  }
  PlyMesh mesh = read_ply(words[1]);
  meshopt_optimizeVertexCacheStrip(mesh.indices.data(), mesh.indices.data(), mesh.indices.size(), mesh.vertices.size());
  meshopt_optimizeVertexFetch(mesh.vertices.data(), mesh.indices.data(), mesh.indices.size(), mesh.vertices.data(),
                              mesh.vertices.size(), sizeof(Position));
  std::vector<unsigned char> indices(meshopt_encodeIndexBufferBound(mesh.indices.size(), mesh.vertices.size()));
  indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), mesh.indices.data(), mesh.indices.size()));
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(mesh.vertices.size(), sizeof(Position)));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), mesh.vertices.data(),
                                             mesh.vertices.size(), sizeof(Position)));
  std::printf("%zu %zu\n", indices.size() + vertices.size(), packed(indices) + packed(vertices));
} catch (const std::exception& failure) {
  std::fprintf(stderr, "meshopt: %s\n", failure.what());
  return 1;
}
