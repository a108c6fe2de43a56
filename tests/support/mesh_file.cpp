#include "tests/support/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

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

// ---- .glb ------------------------------------------------------------------------------------------

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(std::string("GLB: ") + what);
}

Mesh read_glb(std::istream& in, const GridMapping& mapping) {
  using Json = nlohmann::json;
  const std::string bytes{std::istreambuf_iterator<char>{in}, {}};
  std::istringstream words(bytes);
  require(take<std::uint32_t>(words) == 0x46546C67, "magic");
  require(take<std::uint32_t>(words) == 2, "version");
  require(take<std::uint32_t>(words) == bytes.size(), "length");
  const auto json_length = take<std::uint32_t>(words);
  require(json_length % 4 == 0, "chunks begin on four bytes");
  require(take<std::uint32_t>(words) == 0x4E4F534A, "the first chunk is JSON");
  const Json json = Json::parse(bytes.substr(20, json_length));
  require(json.at("asset").at("version") == "2.0", "asset.version");
  const Json& scene = json.at("scenes").at(json.at("scene").get<std::size_t>());
  if (!scene.contains("nodes")) {
    require(bytes.size() == 20 + json_length && !json.contains("meshes"), "an empty scene has nothing else");
    return {};
  }
  words.seekg(20 + static_cast<std::streamoff>(json_length));
  const auto bin_length = take<std::uint32_t>(words);
  require(take<std::uint32_t>(words) == 0x004E4942, "the second chunk is BIN");
  require(28 + std::size_t{json_length} + bin_length == bytes.size() && bin_length % 4 == 0, "length of BIN");
  require(json.at("buffers").size() == 1 && json.at("buffers")[0].at("byteLength") == bin_length, "buffer");

  const Json& node = json.at("nodes").at(scene.at("nodes").at(0).get<std::size_t>());
  const Json& primitive = json.at("meshes").at(node.at("mesh").get<std::size_t>()).at("primitives").at(0);
  require(primitive.value("mode", 4) == 4, "triangles");
  const auto start_of = [&](const Json& accessor, int type, const char* shape, std::size_t size, int target) {
    require(accessor.at("componentType") == type && accessor.at("type") == shape, "accessor");
    const auto count = accessor.at("count").get<std::size_t>();
    const Json& view = json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    const auto from = view.value("byteOffset", std::size_t{0}), length = view.at("byteLength").get<std::size_t>();
    require(count >= 1 && from % 4 == 0 && length == count * size && from + length <= bin_length, "bounds");
    require(view.at("target") == target, "target");
    return 28 + json_length + from;
  };
  const Json& points = json.at("accessors").at(primitive.at("attributes").at("POSITION").get<std::size_t>());
  const Json& corners = json.at("accessors").at(primitive.at("indices").get<std::size_t>());

  Mesh mesh;
  std::array<double, 3> low, high;
  low.fill(1e300), high.fill(-1e300);
  words.seekg(static_cast<std::streamoff>(start_of(points, 5126, "VEC3", 12, 34962)));
  for (std::size_t i = 0; i < points.at("count").get<std::size_t>(); ++i) {
    std::array<double, 3> p{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double v = take<float>(words);
      low[axis] = std::min(low[axis], v), high[axis] = std::max(high[axis], v);
      p[axis] = node.at("translation").at(axis).get<double>() + v * node.at("scale").at(axis).get<double>();
    }
    add_point(mesh, mapping, p[0], -p[2], p[1]);
  }
  require(points.at("min") == Json(low) && points.at("max") == Json(high), "min and max are those of the numbers");
  words.seekg(static_cast<std::streamoff>(start_of(corners, 5125, "SCALAR", 4, 34963)));
  require(corners.at("count").get<std::size_t>() % 3 == 0, "three corners a triangle");
  for (std::size_t i = 0; i < corners.at("count").get<std::size_t>() / 3; ++i) {
    const auto a = take<std::uint32_t>(words), b = take<std::uint32_t>(words), c = take<std::uint32_t>(words);
    require(std::max({a, b, c}) < mesh.points.size(), "indices");
    mesh.triangles.push_back({a, b, c});
  }
  return mesh;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file, const GridMapping& mapping) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + " is not there");
  Mesh mesh = file.extension() == ".obj"   ? read_obj(in, mapping)
              : file.extension() == ".glb" ? read_glb(in, mapping)
                                           : read_ply(in, mapping);
  if (mesh.points.empty()) return mesh;
  mesh.region = {mesh.points[0], mesh.points[0]};
  for (const GridPoint p : mesh.points) {
    mesh.region.first = {std::min(mesh.region.first.col, p.col), std::min(mesh.region.first.row, p.row)};
    mesh.region.last = {std::max(mesh.region.last.col, p.col), std::max(mesh.region.last.row, p.row)};
  }
  return mesh;
}

}  // namespace talus::support
