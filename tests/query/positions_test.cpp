// Meshes as arrays of coordinates, against formulas written here.

#include "talus/positions.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "talus/failure.hpp"

namespace talus::support {
namespace {

/// Two triangles over one cell and a cut beside it.
Mesh square() {
  Mesh mesh;
  mesh.region = {{0, 0}, {1, 1}};
  for (const GridPoint p : {GridPoint{0, 0}, {1, 0}, {0, 1}, {1, 1}}) mesh.points.push_back(p);
  for (const double h : {100.0, 110.0, 120.0, 90.0, 95.0}) mesh.heights.push_back(h);
  mesh.triangles.push_back({0, 2, 3});
  mesh.triangles.push_back({0, 3, 1});
  mesh.cuts = {{0.5, 0.25}};
  return mesh;
}

Description projected() {
  Description d;
  d.mapping = {500000, 4000000, 10, -20};
  d.crs.name = "feet";
  d.crs.metres_per_unit = 0.3048;
  d.metres_per_unit = 0.5;
  return d;
}

Description geographic() {
  Description d;
  d.mapping = {7, 46, 0.01, -0.01};
  d.crs = {"WGS 84", 4326, true, 1, 1, 6378137, 1 / 298.257223563};
  return d;
}

struct Ecef {
  double x, y, z;
};
/// The textbook's closed formula.
Ecef ecef(double lon, double lat, double h) {
  const double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f), rad = std::numbers::pi / 180;
  const double s = std::sin(lat * rad), n = a / std::sqrt(1 - e2 * s * s);
  return {(n + h) * std::cos(lat * rad) * std::cos(lon * rad), (n + h) * std::cos(lat * rad) * std::sin(lon * rad),
          (n * (1 - e2) + h) * s};
}

TEST(Positions, AreThoseOfTheCrs) {
  const std::vector<double> at = positions(square(), projected());
  ASSERT_EQ(at.size(), 15u);
  EXPECT_EQ((std::vector<double>{at.begin() + 3, at.begin() + 6}), (std::vector<double>{500010, 4000000, 110}));
  EXPECT_EQ((std::vector<double>{at.begin() + 12, at.end()}), (std::vector<double>{500005, 3999995, 95})) << "a cut";
}

TEST(Positions, AreMetresFromAnOrigin) {
  const LocalOrigin origin{{500000, 3999980}, 100};
  const std::vector<double> at = positions(square(), projected(), Coordinates::local, origin);
  EXPECT_DOUBLE_EQ(at[1], 20 * 0.3048) << "north";
  EXPECT_DOUBLE_EQ(at[9], 10 * 0.3048);
  EXPECT_DOUBLE_EQ(at[10], 0);
  EXPECT_DOUBLE_EQ(at[11], -5);
  const std::vector<float> floats = float_positions(square(), projected(), Coordinates::local, origin);
  ASSERT_EQ(floats.size(), at.size());
  for (std::size_t i = 0; i < at.size(); ++i) EXPECT_EQ(floats[i], static_cast<float>(at[i]));
}

TEST(Positions, AreOnTheEllipsoid) {
  const Description d = geographic();
  const Mesh mesh = square();
  const std::vector<double> at = positions(mesh, d, Coordinates::ecef);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const Place p = mesh.place(i);
    const Ecef e = ecef(d.mapping.x(p.col), d.mapping.y(p.row), mesh.heights[i]);
    EXPECT_NEAR(at[3 * i], e.x, 1e-6);
    EXPECT_NEAR(at[3 * i + 1], e.y, 1e-6);
    EXPECT_NEAR(at[3 * i + 2], e.z, 1e-6);
  }
}

TEST(Positions, AroundAnOriginKeepDistances) {
  const Description d = geographic();
  const Mesh mesh = square();
  const LocalOrigin origin{{7, 46}, 100};
  const std::vector<double> far = positions(mesh, d, Coordinates::ecef);
  const std::vector<double> near = positions(mesh, d, Coordinates::local, origin);
  const auto distance = [](const std::vector<double>& at, std::size_t i, std::size_t k) {
    return std::hypot(at[3 * i] - at[3 * k], at[3 * i + 1] - at[3 * k + 1], at[3 * i + 2] - at[3 * k + 2]);
  };
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) EXPECT_NEAR(distance(far, i, k), distance(near, i, k), 1e-6);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(near[axis], 0, 1e-6) << "the first corner is the origin";
  EXPECT_GT(near[3], 700) << "east";
  EXPECT_LT(near[7], -1000) << "south";
}

TEST(Positions, OnTheEllipsoidHeightsAreInTheirOwnUnit) {
  Description feet = geographic();
  feet.metres_per_unit = 0.3048;
  Mesh in_metres = square();
  for (double& h : in_metres.heights) h *= 0.3048;
  const LocalOrigin origin{{7, 46}, 50}, in_metres_origin{{7, 46}, 50 * 0.3048};
  for (const Coordinates coordinates : {Coordinates::ecef, Coordinates::local}) {
    const std::vector<double> at = positions(square(), feet, coordinates, origin),
                              expected = positions(in_metres, geographic(), coordinates, in_metres_origin);
    for (std::size_t i = 0; i < at.size(); ++i) EXPECT_NEAR(at[i], expected[i], 1e-6);
  }
  EXPECT_NEAR(positions(square(), feet, Coordinates::local, origin)[2], 50 * 0.3048, 1e-6) << "above the origin";
}

TEST(Positions, NormalsAreUnitVectorsUpward) {
  Mesh mesh = square();
  const Description d = projected();
  for (double& h : mesh.heights) h = 7;
  const std::vector<float> flat = normals(mesh, positions(mesh, d, Coordinates::local));
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    EXPECT_EQ(flat[3 * i], 0);
    EXPECT_EQ(flat[3 * i + 1], 0);
    EXPECT_EQ(flat[3 * i + 2], 1) << "also of a corner without a triangle";
  }
  // A plane that rises one metre a metre eastward.
  for (std::size_t i = 0; i < mesh.size(); ++i) mesh.heights[i] = mesh.place(i).col * 10 * 0.3048 / 0.5;
  const std::vector<float> steep = normals(mesh, positions(mesh, d, Coordinates::local));
  EXPECT_NEAR(steep[0], -std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(steep[2], std::sqrt(0.5), 1e-6);
  // One that rises two metres a metre northward.
  for (std::size_t i = 0; i < mesh.size(); ++i) mesh.heights[i] = -mesh.place(i).row * 20 * 2 * 0.3048 / 0.5;
  const std::vector<float> north = normals(mesh, positions(mesh, d, Coordinates::local));
  EXPECT_NEAR(north[0], 0, 1e-6);
  EXPECT_NEAR(north[1], -2 * std::sqrt(0.2), 1e-6);
  EXPECT_NEAR(north[2], std::sqrt(0.2), 1e-6);
}

TEST(Positions, ANormalIsTheMeanOfItsTrianglesByTheirAreas) {
  Mesh mesh = square();
  mesh.triangles.resize(2);
  // A large triangle that lies flat and a small one that stands upright, at one corner.
  const std::vector<double> at{0, 0, 0, 0, 1, 0, 10, 0, 0, 0, 10, 0, 0, 0, 1};
  mesh.triangles[0] = {0, 2, 3};
  mesh.triangles[1] = {0, 1, 4};
  const std::vector<float> sums = normals(mesh, at);
  const double length = std::hypot(100, 1);
  EXPECT_NEAR(sums[0], 1 / length, 1e-6);
  EXPECT_NEAR(sums[1], 0, 1e-6);
  EXPECT_NEAR(sums[2], 100 / length, 1e-6);
}

TEST(Positions, RefuseWhatTheyCannotGive) {
  const auto cause_of = [](auto&& work) {
    try {
      work();
    } catch (const Failure& failure) {
      return failure.cause();
    }
    return Cause::io;
  };
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(cause_of([] { static_cast<void>(positions(square(), projected(), Coordinates::ecef)); }),
            Cause::unsupported);
  EXPECT_EQ(cause_of([&] {
              static_cast<void>(positions(square(), projected(), Coordinates::local, {{none, 0}, 0}));
            }),
            Cause::invalid_argument);
  for (const LocalOrigin& origin : {LocalOrigin{{0, none}, 0}, LocalOrigin{{0, 0}, none}})
    EXPECT_EQ(cause_of([&] { static_cast<void>(positions(square(), projected(), Coordinates::local, origin)); }),
              Cause::invalid_argument);
  EXPECT_EQ(cause_of([] {
              static_cast<void>(positions(square(), geographic(), Coordinates::local, {{7, 91}, 0}));
            }),
            Cause::invalid_argument);
  EXPECT_EQ(cause_of([] { static_cast<void>(normals(square(), std::vector<double>(3))); }), Cause::invalid_argument);
}

}  // namespace
}  // namespace talus::support
