#include "query/accuracy/true_error.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace talus {
namespace {

using Height = std::function<double(std::int32_t col, std::int32_t row)>;
using Valid = std::function<bool(std::int32_t col, std::int32_t row)>;

SampleReader reader(
    const Height& height, const Valid& valid = [](auto, auto) { return true; }) {
  return [=](GridRect part) {
    SampleWindow window{part, {}, {}};
    for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
      for (std::int32_t col = part.first.col; col <= part.last.col; ++col) {
        window.values.push_back(valid(col, row) ? height(col, row) : std::numeric_limits<double>::quiet_NaN());
        window.valid.push_back(valid(col, row) ? 1 : 0);
      }
    }
    return window;
  };
}

// The rectangle cut once, from north-west to south-east.
Mesh two_triangles(GridRect r, const Height& height) {
  Mesh mesh;
  mesh.region = r;
  mesh.points = {r.first, {r.last.col, r.first.row}, {r.first.col, r.last.row}, r.last};
  for (const GridPoint p : mesh.points) mesh.heights.push_back(height(p.col, p.row));
  mesh.triangles = {{0, 3, 1}, {0, 2, 3}};
  return mesh;
}

double plane(std::int32_t col, std::int32_t row) { return 100 + 2 * col - 3 * row; }

TEST(TrueError, OfAPlaneIsZero) {
  const GridRect region{{-7, -3}, {9, 13}};
  const TrueError found = true_error(two_triangles(region, plane), {}, reader(plane));
  EXPECT_EQ(found.largest_m, 0);
  EXPECT_EQ(found.covered, 17u * 17u);
  EXPECT_EQ(found.uncovered, 0u);
}

TEST(TrueError, FindsTheOneSampleThatIsOff) {
  const GridRect region{{0, 0}, {40, 40}};
  for (const GridPoint off : {GridPoint{0, 0}, {40, 40}, {17, 17}, {40, 3}, {1, 39}}) {
    const auto height = [&](auto col, auto row) { return plane(col, row) + (GridPoint{col, row} == off ? -7.25 : 0); };
    EXPECT_EQ(true_error(two_triangles(region, plane), {}, reader(height)).largest_m, 7.25);
  }
}

TEST(TrueError, IsInMetres) {
  Description description;
  description.metres_per_unit = 0.5;
  const auto height = [](auto col, auto row) { return plane(col, row) + 3; };
  EXPECT_EQ(true_error(two_triangles({{0, 0}, {8, 8}}, plane), description, reader(height)).largest_m, 1.5);
}

TEST(TrueError, TheStripsHideNothing) {
  const GridRect region{{0, 0}, {2000, 3000}};  // several strips
  const auto height = [](auto col, auto row) { return plane(col, row) + (col == 1234 && row == 2345 ? 0.125 : 0); };
  const TrueError found = true_error(two_triangles(region, plane), {}, reader(height));
  EXPECT_EQ(found.largest_m, 0.125);
  EXPECT_EQ(found.covered, 2001u * 3001u);
  EXPECT_EQ(found.uncovered, 0u);
}

TEST(TrueError, CoveredIsWhatAValidFinestTriangleTouches) {
  // Cells are cut between the corners with an even sum, so a void at an odd corner costs one triangle of
  // each cell around it, and a void at an even one all of them.
  const GridRect region{{0, 0}, {1, 1}};
  const Mesh mesh = two_triangles(region, plane);
  const auto all_but = [](GridPoint p) { return [p](auto col, auto row) { return !(GridPoint{col, row} == p); }; };
  EXPECT_EQ(true_error(mesh, {}, reader(plane, all_but({1, 0}))).covered, 3u);
  EXPECT_EQ(true_error(mesh, {}, reader(plane, all_but({0, 0}))).covered, 0u);
}

TEST(TrueError, VoidSamplesAreNotHeldAgainstTheSurface) {
  const auto valid = [](auto col, auto row) { return col != 5 || row != 6; };
  const TrueError found = true_error(two_triangles({{0, 0}, {16, 16}}, plane), {}, reader(plane, valid));
  EXPECT_EQ(found.largest_m, 0);
  EXPECT_EQ(found.covered, 17u * 17u - 1);
}

TEST(TrueError, CountsWhatNoTriangleTouches) {
  Mesh mesh = two_triangles({{0, 0}, {4, 4}}, plane);
  mesh.triangles.pop_back();  // the south-western half, its diagonal stays touched
  const TrueError found = true_error(mesh, {}, reader(plane));
  EXPECT_EQ(found.covered, 25u);
  EXPECT_EQ(found.uncovered, 10u);
}

TEST(TrueError, AHeightThatIsNoNumberIsInfinitelyWrong) {
  Mesh mesh = two_triangles({{0, 0}, {4, 4}}, plane);
  mesh.heights[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isinf(true_error(mesh, {}, reader(plane)).largest_m));
}

TEST(TrueError, CountsEachSampleOnceWithItsSign) {
  // Along the diagonal two triangles meet, and at the corners two or one.
  const GridRect region{{-5, 2}, {35, 42}};
  const auto height = [](auto col, auto row) { return plane(col, row) + (col + row) % 5 - 2; };
  std::vector<int> visits(41 * 41, 0);
  const TrueError found = true_error(two_triangles(region, plane), {}, reader(height), [&](GridPoint p, double metres) {
    ++visits[static_cast<std::size_t>((p.row - 2) * 41 + p.col + 5)];
    EXPECT_DOUBLE_EQ(metres, 2 - (p.col + p.row) % 5);
  });
  EXPECT_EQ(visits, std::vector<int>(41 * 41, 1));
  double squares = 0;
  for (std::int32_t row = 2; row <= 42; ++row) {
    for (std::int32_t col = -5; col <= 35; ++col) squares += ((col + row) % 5 - 2) * ((col + row) % 5 - 2);
  }
  EXPECT_EQ(found.errors.samples(), 41u * 41u);
  EXPECT_NEAR(found.errors.rms(), std::sqrt(squares / (41 * 41)), 1e-12);
  EXPECT_EQ(found.errors.largest(), found.largest_m);
}

TEST(TrueError, WhereSurfacesOverlapTheFartherCounts) {
  Mesh mesh = two_triangles({{0, 0}, {4, 4}}, plane);
  for (const GridPoint p : {GridPoint{0, 0}, {4, 0}, {0, 4}}) {
    mesh.points.push_back(p);
    mesh.heights.push_back(plane(p.col, p.row) - 3);
  }
  mesh.triangles.push_back({4, 6, 5});
  const TrueError found = true_error(mesh, {}, reader(plane));
  EXPECT_EQ(found.errors.samples(), 25u);
  EXPECT_NEAR(found.errors.rms(), std::sqrt(15 * 9.0 / 25), 1e-12);  // a half with its diagonal
}

TEST(TrueError, OfARegionOneSampleWideCoversNothing) {
  Mesh mesh;
  mesh.region = {{3, 0}, {3, 9}};
  const TrueError found = true_error(mesh, {}, reader(plane));
  EXPECT_EQ(found.covered, 0u);
  EXPECT_EQ(found.uncovered, 0u);
}

}  // namespace
}  // namespace talus
