#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "talus/database.hpp"

namespace talus {
namespace {

/// Cuts triangles with the four sides of a frame, one after the other. A cut is computed from the two ends of the
/// mesh's edge, always in the same order, and shared by the triangles at the edge. So triangles that met still meet,
/// and two frames with a common side have the same cuts.
class Clipper {
 public:
  Clipper(const Mesh& mesh, Frame frame) : mesh_(mesh), frame_(frame) {
    for (std::uint32_t i = 0; i < mesh.size(); ++i) vertices_.push_back({mesh.place(i), mesh.heights[i], {i, i}});
  }

  Mesh run() {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint32_t> polygon, kept;
    for (const auto& t : mesh_.triangles) {
      polygon.assign(t.begin(), t.end());
      for (int side = 0; side < 4 && polygon.size() >= 3; ++side) {
        cut(polygon, side, kept);
        polygon.swap(kept);
      }
      for (std::size_t i = 2; i < polygon.size(); ++i) triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
    }
    weld_corners(triangles);
    return used(triangles);
  }

 private:
  struct Vertex {
    Place at;
    double height;
    std::array<std::uint32_t, 2> edge;  ///< the edge that was cut; for a vertex of the mesh, the vertex twice
  };

  /// The distance inside a side: west, east, north, south.
  [[nodiscard]] double inside(const Place& p, int side) const {
    switch (side) {
      case 0: return p.col - frame_.west;
      case 1: return frame_.east - p.col;
      case 2: return p.row - frame_.north;
      default: return frame_.south - p.row;
    }
  }

  /// Cuts a polygon. A polygon that only touches the side leaves nothing.
  void cut(const std::vector<std::uint32_t>& polygon, int side, std::vector<std::uint32_t>& kept) {
    kept.clear();
    bool has_inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const std::uint32_t a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      const double da = inside(vertices_[a].at, side), db = inside(vertices_[b].at, side);
      if (da >= 0) kept.push_back(a);
      has_inside = has_inside || da > 0;
      if ((da > 0 && db < 0) || (da < 0 && db > 0)) kept.push_back(cut_of(a, b, side));
    }
    if (!has_inside) kept.clear();
  }

  /// The ends of the mesh's edge through two vertices; the vertices themselves if there is none.
  [[nodiscard]] std::array<std::uint32_t, 2> edge_through(std::uint32_t a, std::uint32_t b) const {
    const auto &of_a = vertices_[a].edge, &of_b = vertices_[b].edge;
    const bool a_is_cut = of_a[0] != of_a[1], b_is_cut = of_b[0] != of_b[1];
    if (a_is_cut && (of_a == of_b || (!b_is_cut && (of_a[0] == b || of_a[1] == b)))) return of_a;
    if (b_is_cut && !a_is_cut && (of_b[0] == a || of_b[1] == a)) return of_b;
    return {std::min(a, b), std::max(a, b)};
  }

  std::uint32_t cut_of(std::uint32_t one, std::uint32_t other, int side) {
    const auto [a, b] = edge_through(one, other);
    const auto [at, is_new] = cuts_.try_emplace({a, b, side}, static_cast<std::uint32_t>(vertices_.size()));
    if (!is_new) return at->second;
    const auto order = [](const Place& p) { return std::tuple(p.col, p.row); };
    const bool in_order = order(vertices_[a].at) < order(vertices_[b].at);
    const Vertex from = vertices_[in_order ? a : b], to = vertices_[in_order ? b : a];
    const bool by_col = side < 2;
    const double line = side == 0 ? frame_.west : side == 1 ? frame_.east : side == 2 ? frame_.north : frame_.south;
    const double t =
        by_col ? (line - from.at.col) / (to.at.col - from.at.col) : (line - from.at.row) / (to.at.row - from.at.row);
    Vertex cut{{from.at.col + t * (to.at.col - from.at.col), from.at.row + t * (to.at.row - from.at.row)},
               from.height + t * (to.height - from.height),
               {a, b}};
    (by_col ? cut.at.col : cut.at.row) = line;
    vertices_.push_back(cut);
    return at->second;
  }

  /// An edge through a corner of the frame is cut by both sides, at places that differ by rounding. Merges them, and
  /// drops the triangles between.
  void weld_corners(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    constexpr double kNear = 1e-9;  // cells
    std::vector<std::uint32_t> one(vertices_.size());
    for (std::uint32_t i = 0; i < one.size(); ++i) one[i] = i;
    for (const Place corner : {Place{frame_.west, frame_.north},
                               {frame_.east, frame_.north},
                               {frame_.west, frame_.south},
                               {frame_.east, frame_.south}}) {
      std::optional<std::uint32_t> first;
      for (std::uint32_t i = static_cast<std::uint32_t>(mesh_.size()); i < one.size(); ++i) {
        Place& at = vertices_[i].at;
        if (std::abs(at.col - corner.col) > kNear || std::abs(at.row - corner.row) > kNear) continue;
        at = corner;
        if (!first) first = i;
        one[i] = *first;
      }
    }
    std::erase_if(triangles, [&](std::array<std::uint32_t, 3>& t) {
      for (std::uint32_t& v : t) v = one[v];
      return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    });
  }

  /// The vertices that triangles use, grid points first.
  [[nodiscard]] Mesh used(const std::vector<std::array<std::uint32_t, 3>>& triangles) const {
    constexpr std::uint32_t kUnused = ~std::uint32_t{0};
    std::vector<std::uint32_t> number(vertices_.size(), kUnused);
    for (const auto& t : triangles) {
      for (const std::uint32_t v : t) number[v] = 0;
    }
    Mesh mesh;
    mesh.region = mesh_.region;
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (number[i] == kUnused) continue;
      number[i] = next++;
      mesh.heights.push_back(vertices_[i].height);
      if (i < mesh_.points.size()) {
        mesh.points.push_back(mesh_.points[i]);
      } else {
        mesh.cuts.push_back(vertices_[i].at);
      }
    }
    for (const auto& t : triangles) mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    return mesh;
  }

  const Mesh& mesh_;
  Frame frame_;
  std::vector<Vertex> vertices_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, int>, std::uint32_t> cuts_;
};

}  // namespace

Mesh clip_mesh(const Mesh& mesh, Frame frame) { return Clipper(mesh, frame).run(); }

}  // namespace talus
