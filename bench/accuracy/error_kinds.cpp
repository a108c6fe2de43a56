// What kinds of error cost and promise: the vertices that each selects in a window of a model, and how far their mesh
// really is from the samples. One line of JSON for each kind and tolerance.
//
//   error_kinds MODEL COL ROW SIDE METRES...          a window of SIDE + 1 samples each way, without voids
//   error_kinds MODEL COL ROW SIDE --judge MESH       the true error of a mesh of the window that martini.cjs wrote
//
// Kinds, each of a vertex and its two triangles, saturated and selected above the tolerance:
//
//   exact          the largest vertical distance of any sample in the triangles: what Talus stores
//   perpendicular  the same, at a right angle to the triangle; the paper's metric [P98 §5, Eq. 1]
//   nested         the vertex's distance from the middle of its ends, and its children's largest on top: a bound,
//                  unmeasured. On the ladder of stored errors, for there each level's rounding adds up, too
//   midpoint       the vertex's distance alone: no bound
//   exact16        exact on the ladder of stored errors, 16 bits
//   exact8         exact on 255 steps of equal ratio from the smallest error above 0 to the largest, rounded up
//   paper          perpendicular, selected at the tolerance too [P98 §4], for its Table 1
//
// Plain loops over everything: a reference, not a measure of time.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gdal_priv.h>

#include "engine/error/error_ladder.hpp"
#include "engine/error/vertex_error.hpp"
#include "engine/geo/ground.hpp"
#include "engine/quadtree/border.hpp"
#include "engine/quadtree/construction.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "query/accuracy/true_error.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"

namespace talus::bench {
namespace {

/// The least stored error that is not below.
double on_ladder(double error) { return error_of(error_code(error)); }

class Window {
 public:
  Window(const std::string& model, GridRect region) : region_(region), root_(root_side(region)) {
    const Raster raster(model);
    description_ = raster.description();
    samples_ = raster.read(region);
    if (std::find(samples_.valid.begin(), samples_.valid.end(), 0) != samples_.valid.end())
      throw Failure(Cause::invalid_argument, "the window has voids: choose another");
    field_ = {region_, std::span<const double>(samples_.values), {}, CodeDistance({}, description_.metres_per_unit)};
    const Ground ground(description_.crs);
    const GridPoint middle{(region.first.col + region.last.col) / 2, (region.first.row + region.last.row) / 2};
    const GridMapping& m = description_.mapping;
    const Position here{m.x(middle.col), m.y(middle.row)};
    cell_width_ = ground.metres(here, {here.x + m.dx, here.y});
    cell_height_ = ground.metres(here, {here.x, here.y + m.dy});
    for (const GridPoint p : border_vertices(region_, root_)) border_.push_back(p);
  }

  [[nodiscard]] double height(GridPoint p) const { return samples_.values[samples_.index(p)]; }

  /// Metres, by vertex of the window, row by row; those of the root's corners do not count.
  [[nodiscard]] std::vector<double> errors(const std::string& kind) const {
    std::vector<double> all(samples_.values.size());
    for_each_finest_first([&](GridPoint p) {
      double own = 0, below = 0;
      for (const GridPoint child : children_in(p)) below = std::max(below, all[samples_.index(child)]);
      if (kind == "midpoint" || kind == "nested") {
        own = distance_from_middle(p);
        all[samples_.index(p)] = kind == "nested" ? on_ladder(on_ladder(own) + below) : std::max(own, below);
        return;
      }
      for (const int side : {0, 1}) own = std::max(own, half_error(p, side, kind == "perpendicular"));
      all[samples_.index(p)] = std::max(own, below);
    });
    return all;
  }

  /// The mesh of the vertices with larger errors, or as large ones.
  [[nodiscard]] Mesh mesh(const std::vector<double>& errors, double tolerance, bool at_it_too = false) const {
    RestrictedQuadtree q;
    q.region = region_;
    q.vertices = VertexMask(region_);
    for (const GridPoint p : border_) q.vertices.insert(p);
    for_each_finest_first([&](GridPoint p) {
      const double e = errors[samples_.index(p)];
      if (e > tolerance || (at_it_too && e == tolerance)) q.vertices.insert(p);
    });
    close_bottom_up(q.vertices, root_);  // saturated errors are closed but for what the border needs
    q.vertices.seal();
    q.vertices.for_each([&](GridPoint p) { q.heights.push_back(samples_.values[samples_.index(p)]); });
    return triangulate(q, 1);
  }

  [[nodiscard]] double true_error_of(const Mesh& mesh) const {
    return true_error(mesh, description_,
                      [&](GridRect part) {
                        SampleWindow out{part, {}, {}};
                        for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
                          for (std::int32_t col = part.first.col; col <= part.last.col; ++col)
                            out.values.push_back(samples_.values[samples_.index({col, row})]);
                        }
                        out.valid.assign(out.values.size(), 1);
                        return out;
                      })
        .largest_m;
  }

 private:
  template <class Visit>
  void for_each_finest_first(Visit&& visit) const {
    for (std::int32_t s = 1; s < root_; s *= 2) {
      for (const bool centres : {false, true}) {
        for (std::int32_t row = (region_.first.row + s - 1) & -s; row <= region_.last.row; row += s) {
          for (std::int32_t col = (region_.first.col + s - 1) & -s; col <= region_.last.col; col += s) {
            const GridPoint p{col, row};
            if (spacing(p) == s && is_centre(p) == centres) visit(p);
          }
        }
      }
    }
  }

  [[nodiscard]] std::vector<GridPoint> children_in(GridPoint p) const {
    std::vector<GridPoint> inside;
    const Children all = children(p);
    for (int i = 0; i < all.count; ++i) {
      if (region_.contains(all.at[static_cast<std::size_t>(i)])) inside.push_back(all.at[static_cast<std::size_t>(i)]);
    }
    return inside;
  }

  [[nodiscard]] double distance_from_middle(GridPoint p) const {
    const Diamond d = diamond(p);
    if (!region_.contains(d.ends[0]) || !region_.contains(d.ends[1])) return 0;
    const double middle = (field_[d.ends[0]] + field_[d.ends[1]]) / 2;
    return std::abs(field_[p] - middle) * description_.metres_per_unit;
  }

  [[nodiscard]] double half_error(GridPoint p, int side, bool is_perpendicular) const {
    const HalfDiamond t = half_diamond(p, side);
    if (!inside(t, region_)) return 0;
    const Plane<double> plane = plane_of(t, [&](GridPoint q) { return field_[q]; });
    const double metres = field_.distance.metres(largest_distance(field_, t, plane));
    if (!is_perpendicular) return metres;
    const double unit = description_.metres_per_unit;
    return metres / std::hypot(1, plane.right * unit / cell_width_, plane.down * unit / cell_height_);
  }

  GridRect region_;
  std::int32_t root_;
  Description description_;
  SampleWindow samples_;
  HeightField field_;
  double cell_width_ = 1, cell_height_ = 1;
  std::vector<GridPoint> border_;
};

/// Rounded up to 255 steps of equal ratio.
std::vector<double> in_eight_bits(std::vector<double> errors) {
  double least = INFINITY, largest = 0;
  for (const double e : errors) {
    if (e > 0) least = std::min(least, e);
    largest = std::max(largest, e);
  }
  if (!(largest > least)) return errors;
  const double step = std::log(largest / least) / 254;
  for (double& e : errors) {
    if (e > 0) e = std::max(e, least * std::exp(step * std::ceil(std::log(e / least) / step)));
  }
  return errors;
}

std::vector<double> in_sixteen_bits(std::vector<double> errors) {
  for (double& e : errors) e = on_ladder(e);
  return errors;
}

void print(const Window& window, const std::string& name, const std::vector<double>& errors, double tolerance) {
  const Mesh mesh = window.mesh(errors, tolerance, name == "paper");
  fmt::print("{{\"kind\": \"{}\", \"tolerance\": {}, \"vertices\": {}, \"triangles\": {}, \"true_error\": {}}}\n", name,
             tolerance, mesh.points.size(), mesh.triangles.size(), window.true_error_of(mesh));
}

/// As martini.cjs writes one: counts of vertices and triangles, columns and rows in 16 bits, indices in 32.
Mesh mesh_in(const std::string& file, const Window& window, GridRect region) {
  std::ifstream in(file, std::ios::binary);
  const auto read = [&](auto& numbers) {
    in.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(numbers.size() * sizeof(numbers[0])));
    if (!in) throw Failure(Cause::io, file + ": too short for a mesh");
  };
  std::vector<std::uint32_t> counts(2);
  read(counts);
  std::vector<std::uint16_t> places(2 * std::size_t{counts[0]});
  std::vector<std::uint32_t> corners(3 * std::size_t{counts[1]});
  read(places);
  read(corners);
  Mesh mesh;
  mesh.region = region;
  for (std::size_t i = 0; i < places.size(); i += 2) {
    const GridPoint p{region.first.col + places[i], region.first.row + places[i + 1]};
    mesh.points.push_back(p);
    mesh.heights.push_back(window.height(p));
  }
  for (std::size_t i = 0; i < corners.size(); i += 3)
    mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  return mesh;
}

void run(const std::string& model, GridRect region, const std::vector<double>& tolerances) {
  const Window window(model, region);
  const std::vector<double> exact = window.errors("exact"), perpendicular = window.errors("perpendicular");
  const std::vector<std::pair<std::string, std::vector<double>>> kinds{{"exact", exact},
                                                                       {"perpendicular", perpendicular},
                                                                       {"nested", window.errors("nested")},
                                                                       {"midpoint", window.errors("midpoint")},
                                                                       {"exact16", in_sixteen_bits(exact)},
                                                                       {"exact8", in_eight_bits(exact)},
                                                                       {"paper", perpendicular}};
  for (const auto& [name, errors] : kinds) {
    for (const double tolerance : tolerances) print(window, name, errors, tolerance);
  }
}

}  // namespace
}  // namespace talus::bench

int main(int count, char** words) try {
  if (count < 6) {
    std::fputs("error_kinds MODEL COL ROW SIDE METRES... | --judge MESH\n", stderr);
    return 2;
  }
  const std::int32_t col = std::stoi(words[2]), row = std::stoi(words[3]), side = std::stoi(words[4]);
  const talus::GridRect region{{col, row}, {col + side, row + side}};
  GDALAllRegister();
  if (std::strcmp(words[5], "--judge") == 0 && count == 7) {
    const talus::bench::Window window(words[1], region);
    fmt::print("{{\"true_error\": {}}}\n", window.true_error_of(talus::bench::mesh_in(words[6], window, region)));
    return 0;
  }
  std::vector<double> tolerances;
  for (int i = 5; i < count; ++i) tolerances.push_back(std::stod(words[i]));
  talus::bench::run(words[1], region, tolerances);
} catch (const std::exception& failure) {
  std::fprintf(stderr, "error_kinds: %s\n", failure.what());
  return 1;
}
