#include "tests/support/mesh_file.hpp"

#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace talus::support {
namespace {

std::int32_t on_line(double at, double first, double step) {
  const double line = (at - first) / step;
  if (!(std::abs(line - std::round(line)) < 1e-6))
    throw std::runtime_error("a position is no sample's: " + std::to_string(at));
  return static_cast<std::int32_t>(std::lround(line));
}

void add_point(Mesh& mesh, const GridMapping& mapping, double x, double y, double z) {
  mesh.points.push_back({on_line(x, mapping.x0, mapping.dx), on_line(y, mapping.y0, mapping.dy)});
  mesh.heights.push_back(z);
}

template <class Number>
Number take(std::istream& in) {
  std::array<char, sizeof(Number)> bytes;
  if (!in.read(bytes.data(), sizeof(Number))) throw std::runtime_error("the file ends early");
  Number number;
  std::memcpy(&number, bytes.data(), sizeof(Number));
  return number;
}

Mesh read_ply(std::istream& in, const GridMapping& mapping) {
  std::size_t vertices = 0, faces = 0;
  std::string line, properties;
  if (!std::getline(in, line) || line != "ply") throw std::runtime_error("not a PLY");
  if (!std::getline(in, line) || line != "format binary_little_endian 1.0")
    throw std::runtime_error("PLY format: " + line);
  while (std::getline(in, line) && line != "end_header") {
    std::istringstream words(line);
    std::string first, second;
    words >> first >> second;
    if (first == "element" && second == "vertex") words >> vertices;
    if (first == "element" && second == "face") words >> faces;
    if (first == "property") properties += line.substr(9) + ";";
  }
  const bool known = properties == "double x;double y;double z;list uchar int vertex_indices;" ||
                     properties == "double x;double y;double z;list uchar uint vertex_indices;";
  if (!known) throw std::runtime_error("PLY properties: " + properties);
  Mesh mesh;
  for (std::size_t i = 0; i < vertices; ++i) {
    const auto x = take<double>(in), y = take<double>(in), z = take<double>(in);
    add_point(mesh, mapping, x, y, z);
  }
  for (std::size_t i = 0; i < faces; ++i) {
    if (take<std::uint8_t>(in) != 3) throw std::runtime_error("a face is no triangle");
    const auto a = take<std::uint32_t>(in), b = take<std::uint32_t>(in), c = take<std::uint32_t>(in);
    mesh.triangles.push_back({a, b, c});
  }
  if (in.peek() != std::char_traits<char>::eof()) throw std::runtime_error("bytes behind the last face");
  return mesh;
}

Mesh read_obj(std::istream& in, const GridMapping& mapping) {
  Mesh mesh;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::string kind;
    words >> kind;
    if (kind == "v") {
      double x = 0, y = 0, z = 0;
      if (!(words >> x >> y >> z)) throw std::runtime_error("no vertex: " + line);
      add_point(mesh, mapping, x, y, z);
    } else if (kind == "f") {
      std::uint32_t a = 0, b = 0, c = 0;
      if (!(words >> a >> b >> c)) throw std::runtime_error("no triangle: " + line);
      mesh.triangles.push_back({a - 1, b - 1, c - 1});
    }
  }
  return mesh;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file, const GridMapping& mapping) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + " is not there");
  Mesh mesh = file.extension() == ".obj" ? read_obj(in, mapping) : read_ply(in, mapping);
  if (mesh.points.empty()) return mesh;
  mesh.region = {mesh.points[0], mesh.points[0]};
  for (const GridPoint p : mesh.points) {
    mesh.region.first = {std::min(mesh.region.first.col, p.col), std::min(mesh.region.first.row, p.row)};
    mesh.region.last = {std::max(mesh.region.last.col, p.col), std::max(mesh.region.last.row, p.row)};
  }
  return mesh;
}

}  // namespace talus::support
