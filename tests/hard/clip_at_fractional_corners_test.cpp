// Danger: an answer cut at a rectangle whose corners lie on no sample. A cut's height, found from whichever end of the
// edge a triangle begins with, differs in its last digits between the two that share the edge, and a crack opens there.

#include <array>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"
#include "tests/support/surface_of_mesh.hpp"

namespace talus::support {
namespace {

constexpr double kTolerance = 7;

double naive_cut(double from, double to, double t) { return from + t * (to - from); }

HardCase hard_case() {
  HardCase hard{.terrain = fractal(140, 90, 23, 1200)};
  double turn = 0;
  // all bits of a double, about sea level
  for (double& height : hard.terrain.values) height += std::sin(turn += 0.7) - 1400;
  hard.file.type = SampleType::float64;
  return hard;
}

Question question(Frame frame) {
  Question q;
  q.border = Border::clip;
  q.tolerance = Metres{kTolerance};
  q.region = {{static_cast<int>(std::floor(frame.west)), static_cast<int>(std::floor(frame.north))},
              {static_cast<int>(std::ceil(frame.east)), static_cast<int>(std::ceil(frame.south))}};
  return q;
}

/// Vertices on a column, places and heights.
std::set<std::array<double, 2>> on_column(const Mesh& mesh, double col) {
  std::set<std::array<double, 2>> found;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    if (mesh.place(i).col == col) found.insert({mesh.place(i).row, mesh.heights[i]});
  }
  return found;
}

/// The mesh fills its frame and lies on the surface that it was cut out of.
void expect_part_of(const Mesh& mesh, const SurfaceOfMesh& whole, Frame frame) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Place a = mesh.place(t[0]), b = mesh.place(t[1]), c = mesh.place(t[2]);
    const double twice = (b.row - a.row) * (c.col - a.col) - (b.col - a.col) * (c.row - a.row);
    EXPECT_GE(twice, -1e-9) << "turned over";
    area += twice / 2;
  }
  EXPECT_NEAR(area, (frame.east - frame.west) * (frame.south - frame.north), 1e-6);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const auto height = whole.height({mesh.place(i).col, mesh.place(i).row});
    EXPECT_NEAR(mesh.heights[i], height.value_or(mesh.heights[i]), 1e-6);  // none a last digit beyond the outermost
  }
}

TEST(ClipAtFractionalCorners, DependsOnTheEndOneBeginsWith) {
  const Terrain terrain = hard_case().terrain;
  int differ = 0;
  for (int row = 0; row < 90; ++row) {
    for (int col = 0; col < 139; ++col) {  // one in a hundred
      const double a = terrain.at(col, row), b = terrain.at(col + 1, row), t = 1.0 / 3;
      differ += naive_cut(a, b, t) != naive_cut(b, a, 1 - t);
    }
  }
  EXPECT_GT(differ, 5);
}

TEST(ClipAtFractionalCorners, KeepsThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const SurfaceOfMesh whole(database.judged(kTolerance));
  const double third = 1.0 / 3;
  for (const Frame frame : {Frame{10 + third, 8 + third, 100.7, 60.1}, Frame{63.999999, 31.5, 128.000001, 64.25},
                            Frame{5 + 1e-9, 5 + 1e-9, 6 - 1e-9, 6 - 1e-9}, Frame{0, 0, 139, 89},
                            Frame{64 + third, 0, 64 + 2 * third, 89}}) {
    SCOPED_TRACE(::testing::Message() << frame.west << ", " << frame.north << " to " << frame.east << ", "
                                      << frame.south);
    const double middle = frame.west + (frame.east - frame.west) * third;
    const Frame west{frame.west, frame.north, middle, frame.south}, east{middle, frame.north, frame.east, frame.south};
    std::vector<Mesh> parts;
    for (const Frame part : {west, east}) {
      parts.push_back(without_float_exceptions(
          [&] { return clip_mesh(triangulate(database.now().ask(question(part)).quadtree), part); }));
      expect_part_of(parts.back(), whole, part);
    }
    EXPECT_FALSE(on_column(parts[0], middle).empty());
    EXPECT_EQ(on_column(parts[0], middle), on_column(parts[1], middle)) << "bit for bit";
  }
}

}  // namespace
}  // namespace talus::support
