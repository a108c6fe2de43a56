// Writes a mesh as binary glTF 2.0: a header, a chunk of JSON, and a chunk of numbers.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/geo/ground.hpp"
#include "engine/machine/fail.hpp"
#include "query/export/writers.hpp"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

// Numbers from the glTF standard.
constexpr int kFloat = 5126, kUint32 = 5125, kArrayBuffer = 34962, kElementBuffer = 34963, kTriangles = 4;
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;

/// Heights in the file: height = base + float · unit, in the vertical unit.
struct Upward {
  double base = 0, unit = 1;

  [[nodiscard]] float at(double height) const { return static_cast<float>((height - base) / unit); }
  [[nodiscard]] double height(float up) const { return base + static_cast<double>(up) * unit; }
};

/// Whether the float gives the height back. Allows a few units in the last place, because base + float · unit rounds.
bool restores(const Upward& upward, double height) {
  return std::abs(upward.height(upward.at(height)) - height) <=
         4 * 0x1p-52 * (std::abs(height) + std::abs(upward.base));
}

Upward upward_of(const Mesh& mesh, const HeightStep& step) {
  if (mesh.heights.empty()) return {};
  const auto restores_all = [&](const Upward& upward) {
    return std::all_of(mesh.heights.begin(), mesh.heights.end(), [&](double h) { return restores(upward, h); });
  };
  const auto [low, high] = std::minmax_element(mesh.heights.begin(), mesh.heights.end());
  const double middle = *low + (*high - *low) / 2;
  if (const Upward plain{0, 1}; restores_all(plain)) return plain;
  if (step.integer) {
    const double code = std::nearbyint((middle - step.offset) * step.divisor / step.scale);
    if (const Upward steps{step.value(code), step.scale / step.divisor}; restores_all(steps)) return steps;
  }
  return {middle, 1};
}

/// The mesh with the numbers of the file.
class Model {
 public:
  Model(const Mesh& mesh, const Description& description)
      : mesh_(mesh), description_(description), upward_(upward_of(mesh, description.step)) {
    const GridRect& r = mesh.region;
    middle_ = {r.first.col + static_cast<std::int32_t>((r.cols() - 1) / 2),
               r.first.row + static_cast<std::int32_t>((r.rows() - 1) / 2)};
  }

  [[nodiscard]] std::array<float, 3> position(std::size_t i) const {
    const Place p = mesh_.place(i);
    return {static_cast<float>(p.col - middle_.col), upward_.at(mesh_.heights[i]),
            static_cast<float>(p.row - middle_.row)};
  }

  struct Box {
    std::array<float, 3> low{}, high{};
  };
  [[nodiscard]] Box box() const {
    constexpr float kMost = std::numeric_limits<float>::max(), kWhole = 0x1p24F;
    Box box{{kMost, kMost, kMost}, {-kMost, -kMost, -kMost}};
    for (std::size_t i = 0; i < mesh_.size(); ++i) {
      const std::array<float, 3> p = position(i);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(p[axis]))
          throw Failure(Cause::unsupported, "a GLB file stores floats, and a height is too large for them");
        box.low[axis] = std::min(box.low[axis], p[axis]);
        box.high[axis] = std::max(box.high[axis], p[axis]);
      }
    }
    for (const std::size_t axis : {std::size_t{0}, std::size_t{2}}) {
      if (mesh_.size() > 0 && (box.low[axis] < -kWhole || box.high[axis] > kWhole)) {
        fail(Cause::unsupported,
             "a GLB file has at most 16777216 cells on each side of its middle. Ask for a smaller rectangle");
      }
    }
    return box;
  }

  /// How far rounding may move the surface, see write_glb.
  [[nodiscard]] Metres rounding() const {
    double up = 0, sideways = 0;
    for (std::size_t i = 0; i < mesh_.size(); ++i) {
      const double h = mesh_.heights[i];
      if (!restores(upward_, h)) up = std::max(up, std::abs(upward_.height(upward_.at(h)) - h));
    }
    if (!mesh_.cuts.empty()) {
      for (const auto& t : mesh_.triangles) sideways = std::max(sideways, rise_of_moves(t));
    }
    return Metres{(up + sideways) * description_.metres_per_unit};
  }

  [[nodiscard]] Json asset() const {
    const GridMapping& m = description_.mapping;
    return {{"version", "2.0"},
            {"generator", "Talus"},
            {"extras",
             {{"crs_wkt", description_.crs_wkt},
              // Position (x, y, z) of the file has the CRS coordinates origin.x + x·cell.x, origin.y + z·cell.y and
              // the height origin.height + y·cell.height.
              {"origin", {{"x", m.x(middle_.col)}, {"y", m.y(middle_.row)}, {"height", upward_.base}}},
              {"cell", {{"x", m.dx}, {"y", m.dy}, {"height", upward_.unit}}},
              {"vertical_unit", description_.vertical_unit},
              {"metres_per_vertical_unit", description_.metres_per_unit},
              {"rounding_metres", rounding().value}}}};
  }

  [[nodiscard]] Json node() const {
    const GridMapping& m = description_.mapping;
    const Ground ground(description_.crs);
    const double x = m.x(middle_.col), y = m.y(middle_.row), up = description_.metres_per_unit;
    const double east = ground.is_geographic() ? ground.metres({x - m.dx / 2, y}, {x + m.dx / 2, y})
                                               : std::abs(m.dx) * ground.metres_per_unit();
    const double south = ground.is_geographic() ? ground.metres({x, y - m.dy / 2}, {x, y + m.dy / 2})
                                                : std::abs(m.dy) * ground.metres_per_unit();
    const double unit = ground.is_geographic() ? 0 : ground.metres_per_unit();
    return {{"mesh", 0},
            {"translation", {x * unit, upward_.base * up, 0 - y * unit}},
            {"scale", {east, upward_.unit * up, south}}};
  }

 private:
  /// How far the surface moves up or down if corners move sideways: the slope times the largest move, twice, because
  /// the neighbour moves, too. Triangles narrower than a thousandth of a cell are left out.
  [[nodiscard]] double rise_of_moves(const std::array<std::uint32_t, 3>& t) const {
    double move = 0;
    for (const std::uint32_t id : t) {
      const Place p = mesh_.place(id);
      const double col = p.col - middle_.col, row = p.row - middle_.row;
      move = std::max(move, std::hypot(static_cast<double>(static_cast<float>(col)) - col,
                                       static_cast<double>(static_cast<float>(row)) - row));
    }
    const Place a = mesh_.place(t[0]), b = mesh_.place(t[1]), c = mesh_.place(t[2]);
    const double area = (b.col - a.col) * (c.row - a.row) - (b.row - a.row) * (c.col - a.col);
    if (move == 0 || std::abs(area) < 1e-3) return 0;
    const double hb = mesh_.heights[t[1]] - mesh_.heights[t[0]], hc = mesh_.heights[t[2]] - mesh_.heights[t[0]];
    const double east = (hb * (c.row - a.row) - hc * (b.row - a.row)) / area;
    const double south = (hc * (b.col - a.col) - hb * (c.col - a.col)) / area;
    return 2 * move * std::hypot(east, south);
  }

  const Mesh& mesh_;
  const Description& description_;
  Upward upward_;
  GridPoint middle_;
};

/// The JSON of the file. glTF has no empty mesh: without triangles the scene is empty.
Json document(const Model& model, std::size_t points, std::size_t triangles) {
  Json json{{"asset", model.asset()}, {"scene", 0}};
  if (triangles == 0) {
    json["scenes"] = Json::array({Json::object()});
    return json;
  }
  const Model::Box box = model.box();
  json["scenes"] = Json::array({{{"nodes", {0}}}});
  json["nodes"] = Json::array({model.node()});
  json["meshes"] = Json::array(
      {{{"primitives", Json::array({{{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"mode", kTriangles}}})}}});
  json["accessors"] =
      Json::array({{{"bufferView", 0},
                    {"componentType", kFloat},
                    {"count", points},
                    {"type", "VEC3"},
                    {"min", box.low},
                    {"max", box.high}},
                   {{"bufferView", 1}, {"componentType", kUint32}, {"count", 3 * triangles}, {"type", "SCALAR"}}});
  json["bufferViews"] = Json::array(
      {{{"buffer", 0}, {"byteLength", 12 * points}, {"target", kArrayBuffer}},
       {{"buffer", 0}, {"byteOffset", 12 * points}, {"byteLength", 12 * triangles}, {"target", kElementBuffer}}});
  json["buffers"] = Json::array({{{"byteLength", 12 * (points + triangles)}}});
  return json;
}

}  // namespace

Metres write_glb(const Mesh& mesh, const Description& description, OutputFile& out) {
  const Model model(mesh, description);
  // Bytes that are not UTF-8, in the name of a CRS, are dropped.
  std::string json =
      document(model, mesh.size(), mesh.triangles.size()).dump(-1, ' ', false, Json::error_handler_t::replace);
  json.append((4 - json.size() % 4) % 4, ' ');
  const std::uint64_t numbers = mesh.triangles.empty() ? 0 : 12 * std::uint64_t{mesh.size() + mesh.triangles.size()};
  const std::uint64_t bytes = 12 + 8 + json.size() + (numbers > 0 ? 8 + numbers : 0);
  if (bytes > std::numeric_limits<std::uint32_t>::max()) {
    fail(Cause::unsupported,
         "a GLB file has at most 4 GiB, but {} vertices with {} triangles need more. Ask for a smaller rectangle or a "
         "larger tolerance",
         mesh.size(), mesh.triangles.size());
  }
  for (const std::uint32_t word : {kMagic, kVersion, static_cast<std::uint32_t>(bytes)}) out.write_little_endian(word);
  out.write_little_endian(static_cast<std::uint32_t>(json.size()));
  out.write_little_endian(kJsonChunk);
  out.write(json);
  if (numbers == 0) return Metres{0};
  out.write_little_endian(static_cast<std::uint32_t>(numbers));
  out.write_little_endian(kBinChunk);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    for (const float v : model.position(i)) out.write_little_endian(v);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t id : triangle) out.write_little_endian(id);
  }
  return model.rounding();
}

}  // namespace talus
