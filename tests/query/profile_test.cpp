// Profiles, held against the triangles of the answer, looked at densely, and against the raster's own samples.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/geo/ground.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/random_raster.hpp"
#include "tests/support/surface_of_mesh.hpp"

namespace talus {
namespace {

using namespace support;

Snapshot snapshot_of(const Terrain& terrain, const TempFolder& folder, const RasterOptions& file = {},
                     const IngestOptions& options = {}) {
  write_raster(terrain, folder / "a.tif", file);
  ingest(folder / "a.tif", folder / "a.talus", options);
  return Database::open(folder / "a.talus").snapshot();
}

using Line = std::vector<Position>;

/// Position of a column and row.
Position at(const Description& d, double col, double row) {
  return {d.mapping.x0 + col * d.mapping.dx, d.mapping.y0 + row * d.mapping.dy};
}

/// The profile of a line of two points at a share of it, if there is one there.
std::optional<double> height_at(const Profile& profile, Position begin, Position end, double share) {
  const auto share_of = [&](const ProfileVertex& v) {
    return std::abs(end.x - begin.x) > std::abs(end.y - begin.y) ? (v.x - begin.x) / (end.x - begin.x)
                                                                 : (v.y - begin.y) / (end.y - begin.y);
  };
  for (const auto& part : profile.parts) {
    for (std::size_t i = 0; i + 1 < part.size(); ++i) {
      const double a = share_of(part[i]), b = share_of(part[i + 1]);
      if (share < a - 1e-9 || share > b + 1e-9 || a == b) continue;  // coordinates of vertices are rounded
      return part[i].height + (part[i + 1].height - part[i].height) * (share - a) / (b - a);
    }
  }
  return std::nullopt;
}

double random_line(Random& random, std::int32_t first, std::int32_t last) {
  return random.chance(0.5) ? random.between(first, last) : random.within(first - 0.3, last + 0.3);
}

TEST(Profiles, AreTheSurfaceOfTheMeshWithinWhatIsLeftOfTheTolerance) {
  const int cases = property_cases(60);
  std::size_t seen = 0, doubtful = 0;
  for (int seed = 0; seed < cases; ++seed) {
    RandomRaster raster = random_raster(static_cast<std::uint64_t>(seed) + 5000);
    if (raster.terrain.cols < 2 || raster.terrain.rows < 2) continue;
    const TempFolder folder;
    const Snapshot now = snapshot_of(raster.terrain, folder, raster.file);
    const Description& d = now.description();
    const auto& [first, last] = d.extent;
    Random random(static_cast<std::uint64_t>(seed) + 11);
    const Metres tolerance{random_tolerance(random)};
    const SurfaceOfMesh surface(now.mesh(Metres{tolerance.value / 2}));
    for (int round = 0; round < 12; ++round) {
      double c0 = random_line(random, first.col, last.col), r0 = random_line(random, first.row, last.row);
      double c1 = random_line(random, first.col, last.col), r1 = random_line(random, first.row, last.row);
      if (round == 0) r0 = r1 = first.row;  // along the border
      if (round == 1) c0 = c1 = last.col;
      if (round == 2) r0 = r1 = std::nearbyint(r0);  // along edges
      if (round == 3) c1 = c0 + (r1 - r0);           // a diagonal
      if (round == 4) c1 = (c0 = std::nearbyint(c0)) + (r1 = std::nearbyint(r1)) - (r0 = std::nearbyint(r0));
      if (c0 == c1 && r0 == r1) continue;
      const Position begin = at(d, c0, r0), end = at(d, c1, r1);
      const Profile profile = now.profile(Line{begin, end}, tolerance);
      EXPECT_LE(profile.bound.value, tolerance.value + 2e-9);
      const double slack = std::isinf(tolerance.value) ? 1e300 : tolerance.value / 2 / d.metres_per_unit;
      for (int i = 0; i <= 400; ++i) {
        const double share = i / 400.0;
        const MeshPlace place{c0 + (c1 - c0) * share, r0 + (r1 - r0) * share};
        if (surface.is_doubtful(place, 1e-5)) {
          ++doubtful;
          continue;
        }
        const auto expected = surface.height(place), found = height_at(profile, begin, end, share);
        ++seen;
        const auto beside = [&](double by) {
          if (share + by < 0 || share + by > 1) return false;
          return surface.height({c0 + (c1 - c0) * (share + by), r0 + (r1 - r0) * (share + by)}).has_value();
        };
        if (!found && !beside(1e-5) && !beside(-1e-5)) continue;  // a triangle's corner, touched and left
        const std::string where = raster.description + ", seed " + std::to_string(seed) + ", round " +
                                  std::to_string(round) + " at column " + std::to_string(place.col) + ", row " +
                                  std::to_string(place.row) + ", " + std::to_string(tolerance.value) + " m";
        ASSERT_EQ(found.has_value(), expected.has_value()) << where;
        if (found) {
          ASSERT_LE(std::abs(*found - *expected), slack + 1e-6 * (1 + std::abs(*expected))) << where;
        }
      }
      double reached = 0;
      for (const auto& part : profile.parts) {
        EXPECT_GE(part.size(), 2u);
        for (const ProfileVertex& v : part) {
          EXPECT_GE(v.distance.value, reached);
          reached = v.distance.value;
        }
      }
      EXPECT_LE(reached, profile.length.value * (1 + 1e-12));
    }
  }
  EXPECT_LT(doubtful, seen / 10);
}

TEST(Profiles, AreWithinTheToleranceOfSamples) {
  const Terrain terrain = fit(fractal(600, 500, 8), SampleType::int16);
  const TempFolder folder;
  const Snapshot now = snapshot_of(terrain, folder);
  const Description& d = now.description();
  std::size_t before = 1 << 30;
  for (const double tolerance : {0.0, 1.0, 5.0, 30.0, 200.0}) {
    std::size_t vertices = 0;
    for (const int row : {0, 7, 128, 300, 499}) {
      const Position begin = at(d, 0, row), end = at(d, 599, row);
      const Profile profile = now.profile(Line{begin, end}, Metres{tolerance});
      ASSERT_EQ(profile.parts.size(), 1u);
      for (int col = 0; col < 600; ++col) {
        const auto height = height_at(profile, begin, end, col / 599.0);
        ASSERT_TRUE(height);
        ASSERT_LE(std::abs(*height - terrain.at(col, row)), tolerance + 1e-8);
      }
      vertices += profile.parts[0].size();
    }
    EXPECT_LE(vertices, before) << "a looser tolerance needs no more";
    before = vertices;
  }
}

TEST(Profiles, OfAPlaneHaveTheLinesPointsOnly) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(plane(200, 150), folder);
  const Profile profile = now.profile(Line{{10.25, -20.5}, {150, -20.5}, {150, -20.5}, {151, -140}}, Metres{0.5});
  ASSERT_EQ(profile.parts.size(), 1u);
  ASSERT_EQ(profile.parts[0].size(), 3u);
  const auto& [a, b, c] = std::tie(profile.parts[0][0], profile.parts[0][1], profile.parts[0][2]);
  EXPECT_EQ(a.distance.value, 0);
  EXPECT_EQ(b.distance.value, 139.75);
  EXPECT_DOUBLE_EQ(c.distance.value, 139.75 + std::hypot(1, 119.5));
  EXPECT_EQ(profile.length.value, c.distance.value);
  EXPECT_EQ(b.x, 150);
  EXPECT_EQ(b.y, -20.5);
  EXPECT_NEAR(a.height, 100 + 9.75 + 40, 1e-9);
  EXPECT_NEAR(c.height, 100 + 150.5 + 2 * 139.5, 1e-9);
}

TEST(Profiles, BreakAtVoidsAndAtTheEdge) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(hole(plane(100, 100), 40, 0, 60, 99), folder);
  const Profile profile = now.profile(Line{{-50, -30.5}, {150, -30.5}}, Metres{0});
  ASSERT_EQ(profile.parts.size(), 2u);
  EXPECT_NEAR(profile.parts[0].front().x, 0.5, 1e-9);
  EXPECT_NEAR(profile.parts[0].back().x, 39.5, 1e-9);
  EXPECT_NEAR(profile.parts[1].front().x, 61.5, 1e-9);
  EXPECT_NEAR(profile.parts[1].back().x, 99.5, 1e-9);
  EXPECT_NEAR(profile.parts[1].front().distance.value, 111.5, 1e-9);
  EXPECT_TRUE(now.profile(Line{{45, -5}, {55, -95}}, Metres{0}).parts.empty());
  EXPECT_TRUE(now.profile(Line{{-45, -5}, {-55, 95}}, Metres{0}).parts.empty());
}

TEST(Profiles, OfALineAreThoseOfItsStretchesOneAfterTheOther) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(fit(void_blobs(fractal(300, 200, 4), 4, 9), SampleType::int16), folder);
  Random random(5);
  std::vector<Position> line;
  for (int i = 0; i < 12; ++i) line.push_back({random.within(-5, 305), random.within(-205, 5)});
  const Profile whole = now.profile(line, Metres{3});
  std::vector<ProfileVertex> expected, found;
  double begun = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Profile stretch = now.profile(std::span(line).subspan(i, 2), Metres{3});
    for (const auto& part : stretch.parts) {
      for (ProfileVertex v : part) {
        v.distance.value += begun;
        if (!expected.empty() && std::abs(expected.back().distance.value - v.distance.value) < 1e-9) continue;
        expected.push_back(v);
      }
    }
    begun += stretch.length.value;
  }
  for (const auto& part : whole.parts) found.insert(found.end(), part.begin(), part.end());
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].distance.value, expected[i].distance.value, 1e-9);
    EXPECT_NEAR(found[i].height, expected[i].height, 1e-9);
  }
  EXPECT_NEAR(whole.length.value, begun, 1e-9);
}

TEST(Profiles, OfALongDiagonalReadThePagesAlongIt) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(fit(fractal(2000, 2000, 2), SampleType::int16), folder);
  const Profile profile = now.profile(Line{{1, -1}, {1999, -1950}}, Metres{0.5});
  EXPECT_GT(profile.parts.at(0).size(), 100u);
  EXPECT_LE(profile.cost.pages_read, 1u + 3 * 16 + 2 * 4 + 1) << "of 256 pages";
}

TEST(Profiles, RefuseWhatIsNoLine) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(plane(10, 10), folder);
  const auto refused = [&](std::vector<Position> line, double tolerance) {
    try {
      static_cast<void>(now.profile(line, Metres{tolerance}));
    } catch (const Failure& failure) {
      return failure.cause() == Cause::invalid_argument;
    }
    return false;
  };
  EXPECT_TRUE(refused({}, 1));
  EXPECT_TRUE(refused({{1, -1}}, 1));
  EXPECT_TRUE(refused({{1, -1}, {1, -1}}, 1));
  EXPECT_TRUE(refused({{1, -1}, {NAN, -1}}, 1));
  EXPECT_TRUE(refused({{1, -1}, {2, -INFINITY}}, 1));
  EXPECT_TRUE(refused({{1, -1}, {2, -2}}, -1));
  EXPECT_TRUE(refused({{1, -1}, {2, -2}}, NAN));
}

TEST(Profiles, OfALineOfSamplesAreEmpty) {
  for (const auto& [cols, rows] : {std::pair{1, 1}, {1, 30}, {30, 1}}) {
    const TempFolder folder;
    const Snapshot now = snapshot_of(plane(cols, rows), folder);
    EXPECT_TRUE(now.profile(Line{{0, 0}, {30, -30}}, Metres{1}).parts.empty());
  }
}

// ---- lengths ---------------------------------------------------------------------------------------

/// Chords between many points on the ellipsoid WGS 84.
double chords(Position from, Position to) {
  constexpr double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f), degree = std::numbers::pi / 180;
  const auto place = [&](double t) {
    const double lon = (from.x + (to.x - from.x) * t) * degree, lat = (from.y + (to.y - from.y) * t) * degree;
    const double n = a / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
    return std::array{n * std::cos(lat) * std::cos(lon), n * std::cos(lat) * std::sin(lon),
                      n * (1 - e2) * std::sin(lat)};
  };
  double sum = 0;
  constexpr int kSteps = 200000;
  for (int i = 0; i < kSteps; ++i) {
    const auto p = place(i / double(kSteps)), q = place((i + 1) / double(kSteps));
    sum += std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
  }
  return sum;
}

CrsFacts facts_of(const char* crs, const TempFolder& folder) {
  RasterOptions file;
  file.crs = crs;
  return snapshot_of(plane(3, 3), folder, file).description().crs;
}

TEST(Ground, OfDegreesIsTheEllipsoids) {
  const TempFolder folder;
  RasterOptions file;
  file.crs = "EPSG:4326";
  file.geotransform = {7, 0.01, 0, 47, 0, -0.01};
  const Ground ground(snapshot_of(plane(3, 3), folder, file).description().crs);
  for (const auto& [from, to] : {std::pair{Position{7, 46}, Position{8, 46}},
                                 {{7, 46}, {7, 47}},
                                 {{-20, -40}, {70, 85}},
                                 {{7.5, 45.9}, {7.6, 45.91}},
                                 {{0, 0}, {0, 90}}}) {
    const double expected = chords(from, to);
    EXPECT_NEAR(ground.metres(from, to), expected, 1e-8 * expected);
  }
  EXPECT_EQ(ground.metres({7, 46}, {7, 46}), 0);
}

TEST(Ground, OfAProjectionIsInItsUnit) {
  const TempFolder folder;
  EXPECT_DOUBLE_EQ(Ground(CrsFacts{}).metres({0, 0}, {3, 4}), 5);
  EXPECT_DOUBLE_EQ(Ground(facts_of("EPSG:2225", folder)).metres({0, 0}, {3, 4}), 5 * 1200.0 / 3937) << "US survey feet";
}

}  // namespace
}  // namespace talus
