// The judge of all other tests is judged here: by meshes made by hand, and by one defect at a time.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/oracle.hpp"

namespace talus::support {
namespace {

Mesh points_of(const Terrain& terrain, GridRect region) {
  Mesh mesh;
  mesh.region = region;
  for (std::int32_t row = region.first.row; row <= region.last.row; ++row) {
    for (std::int32_t col = region.first.col; col <= region.last.col; ++col) {
      mesh.points.push_back({col, row});
      mesh.heights.push_back(terrain.at(col, row));
    }
  }
  return mesh;
}

GridRect all_of(const Terrain& terrain) { return {{0, 0}, {terrain.cols - 1, terrain.rows - 1}}; }

/// Every finest triangle of the region, or those without void corners.
Mesh finest_mesh(const Terrain& terrain) {
  Mesh mesh = points_of(terrain, all_of(terrain));
  const auto id = [&](int col, int row) { return static_cast<std::uint32_t>(row * terrain.cols + col); };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (terrain.valid[a] != 0 && terrain.valid[b] != 0 && terrain.valid[c] != 0) mesh.triangles.push_back({a, b, c});
  };
  for (int row = 0; row + 1 < terrain.rows; ++row) {
    for (int col = 0; col + 1 < terrain.cols; ++col) {
      const auto nw = id(col, row), ne = id(col + 1, row), sw = id(col, row + 1), se = id(col + 1, row + 1);
      if ((col + row) % 2 == 0) {
        add(nw, se, ne);
        add(nw, sw, se);
      } else {
        add(nw, sw, ne);
        add(ne, sw, se);
      }
    }
  }
  return mesh;
}

/// Drops points that no triangle uses.
Mesh without_orphans(const Mesh& mesh) {
  Mesh kept;
  kept.region = mesh.region;
  std::vector<std::uint32_t> now(mesh.points.size(), ~0u);
  for (auto triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      if (now[corner] == ~0u) {
        now[corner] = static_cast<std::uint32_t>(kept.points.size());
        kept.points.push_back(mesh.points[corner]);
        kept.heights.push_back(mesh.heights[corner]);
      }
      corner = now[corner];
    }
    kept.triangles.push_back(triangle);
  }
  return kept;
}

/// Two triangles over a square of 2^k cells, cut from north-west to south-east.
Mesh two_triangles(const Terrain& terrain) {
  Mesh mesh;
  mesh.region = all_of(terrain);
  const std::int32_t far = terrain.cols - 1;
  mesh.points = {{0, 0}, {far, 0}, {0, far}, {far, far}};
  for (const GridPoint p : mesh.points) mesh.heights.push_back(terrain.at(p.col, p.row));
  mesh.triangles = {{0, 3, 1}, {0, 2, 3}};
  return mesh;
}

TEST(Oracle, AcceptsThePlaneInTwoTriangles) {
  const Terrain terrain = plane(17, 17);
  const auto report = check_mesh(two_triangles(terrain), terrain, 1, 0);
  EXPECT_TRUE(report.sound()) << report.summary();
  EXPECT_TRUE(report.exact);
  EXPECT_EQ(report.largest_error, 0);
  EXPECT_EQ(report.covered_samples, 17u * 17u);
  EXPECT_EQ(report.finest_triangles, 2u * 16u * 16u);
}

TEST(Oracle, AcceptsEveryFinestTriangleAndARegionOfThem) {
  const Terrain terrain = noise(23, 9, 5);
  const auto report = check_mesh(finest_mesh(terrain), terrain, 1, 0);
  EXPECT_TRUE(report.sound()) << report.summary();
  EXPECT_EQ(report.largest_error, 0);
}

TEST(Oracle, MeasuresTheSpikeExactly) {
  const Terrain terrain = spike(17, 17, 5, 9, 50);
  const auto at_the_error = check_mesh(two_triangles(terrain), terrain, 1, 50);
  EXPECT_TRUE(at_the_error.sound()) << at_the_error.summary();
  EXPECT_EQ(at_the_error.largest_error, 50);
  EXPECT_EQ(at_the_error.worst_sample, (GridPoint{5, 9}));
  const auto below = check_mesh(two_triangles(terrain), terrain, 1, std::nextafter(50.0, 0.0));
  EXPECT_EQ(below.triangles_over, 1u);
  EXPECT_FALSE(below.sound());
}

TEST(Oracle, ComparesThirdsOfABitExactly) {
  // A quarter along a side: 3/4 · 1 + 1/4 · 0 against 0, and the tolerance one bit below 0.75.
  Terrain terrain = plane(5, 5, 0, 0, 0);
  for (int row = 0; row < 5; ++row) terrain.at(0, row) = 1;
  const Mesh mesh = two_triangles(terrain);
  EXPECT_TRUE(check_mesh(mesh, terrain, 1, 0.75).sound());
  EXPECT_EQ(check_mesh(mesh, terrain, 1, std::nextafter(0.75, 0.0)).triangles_over, 2u);
}

TEST(Oracle, MeasuresInMetres) {
  const Terrain terrain = pit(9, 9, 4, 3, 10);
  const auto report = check_mesh(two_triangles(terrain), terrain, 0.3048, 3.048);
  EXPECT_TRUE(report.sound()) << report.summary();
  EXPECT_NEAR(report.largest_error, 3.048, 1e-12);
  EXPECT_FALSE(report.exact);
  EXPECT_FALSE(check_mesh(two_triangles(terrain), terrain, 0.3048, 3.0479).sound());
}

TEST(Oracle, MeasuresHeightsThatAreNoBinaryFractions) {
  Terrain terrain = spike(9, 9, 3, 4, 0.1);
  terrain.at(0, 0) = 100.3;
  const auto report = check_mesh(two_triangles(terrain), terrain, 1, 0.3);
  EXPECT_FALSE(report.exact);
  EXPECT_TRUE(report.sound()) << report.summary();
  EXPECT_NEAR(report.largest_error, 0.3 * 7 / 8, 1e-12);  // beside the raised corner, on a leg or the cut
}

TEST(Oracle, MeasuresTheLargestHeightsWithoutOverflow) {
  Terrain terrain = plane(129, 129, 0, 0, 0);
  terrain.at(64, 64) = 0x1p40;
  terrain.at(128, 128) = -0x1p40;
  const auto report = check_mesh(two_triangles(terrain), terrain, 1, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(report.sound()) << report.summary();
  EXPECT_TRUE(report.exact);
  EXPECT_EQ(report.largest_error, 1.5 * 0x1p40);
}

TEST(Oracle, FlagsAFlippedTriangle) {
  const Terrain terrain = plane(9, 9);
  Mesh mesh = finest_mesh(terrain);
  std::swap(mesh.triangles[40][0], mesh.triangles[40][1]);
  const auto report = check_mesh(mesh, terrain, 1, 0);
  EXPECT_EQ(report.flipped, 1u);
  EXPECT_GT(report.overused_edges, 0u);
}

TEST(Oracle, FlagsADegenerateTriangle) {
  const Terrain terrain = plane(9, 9);
  Mesh mesh = finest_mesh(terrain);
  mesh.triangles.push_back({0, 1, 2});
  EXPECT_EQ(check_mesh(mesh, terrain, 1, 0).degenerate, 1u);
}

TEST(Oracle, FlagsAMissingTriangle) {
  const Terrain terrain = plane(9, 9);
  Mesh mesh = finest_mesh(terrain);
  mesh.triangles.erase(mesh.triangles.begin() + 50);
  const auto report = check_mesh(mesh, terrain, 1, 0);
  EXPECT_EQ(report.uncovered_triangles, 1u);
  EXPECT_EQ(report.stray_edges, 3u);
  EXPECT_EQ(report.uncovered_samples, 0u);  // its corners are corners of others
  EXPECT_TRUE(report.area_wrong);
}

TEST(Oracle, FlagsSamplesThatNoTriangleHolds) {
  const Terrain terrain = plane(9, 9);
  Mesh mesh = two_triangles(terrain);
  mesh.triangles.pop_back();
  const auto report = check_mesh(mesh, terrain, 1, 0);
  EXPECT_EQ(report.uncovered_samples, 36u);
  EXPECT_EQ(report.orphan_points, 1u);
}

TEST(Oracle, FlagsADuplicateTriangle) {
  const Terrain terrain = plane(9, 9);
  Mesh mesh = finest_mesh(terrain);
  mesh.triangles.push_back(mesh.triangles[7]);
  const auto report = check_mesh(mesh, terrain, 1, 0);
  EXPECT_EQ(report.overlapped_triangles, 1u);
  EXPECT_GT(report.overused_edges, 0u);
}

/// Two triangles, one of them split at the middle of the cut: the other has a vertex inside its edge.
Mesh cracked(const Terrain& terrain) {
  Mesh mesh = two_triangles(terrain);
  const std::int32_t half = (terrain.cols - 1) / 2;
  mesh.points.push_back({half, half});
  mesh.heights.push_back(terrain.at(half, half));
  mesh.triangles = {{0, 3, 1}, {0, 2, 4}, {2, 3, 4}};
  return mesh;
}

TEST(Oracle, FlagsACrackEvenWhereItIsClosed) {
  const Terrain terrain = plane(17, 17);  // on a plane nothing gapes, and it is a defect all the same
  const auto report = check_mesh(cracked(terrain), terrain, 1, 0);
  EXPECT_EQ(report.largest_error, 0);
  EXPECT_EQ(report.t_junctions, 1u);
  EXPECT_EQ(report.stray_edges, 3u);
}

TEST(Oracle, FlagsACrackBesideAHole) {
  Terrain terrain = plane(17, 17);
  terrain.make_void(16, 0);  // now edges used once may also be the outline's: not these
  const auto report = check_mesh(cracked(terrain), terrain, 1, 0);
  EXPECT_EQ(report.t_junctions, 1u);
  EXPECT_EQ(report.stray_edges, 3u);
}

TEST(Oracle, FlagsTwoPointsAtOnePlace) {
  const Terrain terrain = plane(9, 9);
  Mesh mesh = finest_mesh(terrain);
  mesh.points.push_back(mesh.points[40]);
  mesh.heights.push_back(mesh.heights[40]);
  for (auto& triangle : mesh.triangles) {
    for (auto& corner : triangle) {
      if (corner == 40) {
        corner = static_cast<std::uint32_t>(mesh.points.size() - 1);
        goto done;
      }
    }
  }
done:
  const auto report = check_mesh(mesh, terrain, 1, 0);
  EXPECT_EQ(report.duplicate_points, 1u);
  EXPECT_GT(report.stray_edges, 0u);
}

TEST(Oracle, FlagsAWrongHeight) {
  const Terrain terrain = plane(9, 9);
  Mesh mesh = finest_mesh(terrain);
  mesh.heights[30] += 0.001;
  const auto report = check_mesh(mesh, terrain, 1, 1);
  EXPECT_EQ(report.wrong_heights, 1u);
  EXPECT_NEAR(report.largest_error, 0.001, 1e-12);
}

TEST(Oracle, FlagsPointsOutsideAndBadIndices) {
  const Terrain terrain = plane(9, 9);
  Mesh outside = two_triangles(terrain);
  outside.region.last = {7, 8};
  EXPECT_EQ(check_mesh(outside, terrain, 1, 0).outside_points, 2u);
  Mesh bad = two_triangles(terrain);
  bad.triangles[0][1] = 4;
  EXPECT_EQ(check_mesh(bad, terrain, 1, 0).bad_indices, 1u);
}

TEST(Oracle, FlagsANaN) {
  const Terrain terrain = plane(9, 9);
  Mesh mesh = two_triangles(terrain);
  mesh.heights[1] = std::numeric_limits<double>::quiet_NaN();
  const auto report = check_mesh(mesh, terrain, 1, 1000);
  EXPECT_EQ(report.wrong_heights, 1u);
  EXPECT_EQ(report.triangles_over, 1u);
}

TEST(Oracle, TakesAnOutlineForWhatItIs) {
  const Terrain terrain = hole(plane(17, 17), 4, 5, 9, 8);
  const Mesh mesh = without_orphans(finest_mesh(terrain));
  const auto report = check_mesh(mesh, terrain, 1, 0);
  EXPECT_TRUE(report.sound()) << report.summary();
  EXPECT_EQ(report.covered_samples, 17u * 17u - 6u * 4u);
}

TEST(Oracle, FlagsAMissingTriangleBesideAHole) {
  const Terrain terrain = hole(plane(17, 17), 4, 5, 9, 8);
  Mesh mesh = without_orphans(finest_mesh(terrain));
  mesh.triangles.erase(mesh.triangles.begin() + 10);
  EXPECT_EQ(check_mesh(mesh, terrain, 1, 0).uncovered_triangles, 1u);
}

TEST(Oracle, FlagsATriangleOverNothing) {
  Terrain terrain = hole(plane(17, 17), 4, 5, 9, 8);
  const Mesh mesh = [&] {
    Terrain patched = terrain;
    patched.valid[patched.index(4, 5)] = 1;
    return without_orphans(finest_mesh(patched));
  }();
  const auto report = check_mesh(mesh, terrain, 1, 0);
  EXPECT_GT(report.idle_triangles, 0u);
  EXPECT_EQ(report.uncovered_triangles, 0u);
}

TEST(Oracle, FlagsAnOutlineTooCoarse) {
  Terrain terrain = plane(17, 17);
  terrain.make_void(16, 0);
  OracleOptions options;
  options.cell_width_m = options.cell_height_m = 10;
  const auto fine = check_mesh(two_triangles(terrain), terrain, 1, 227, options);
  EXPECT_TRUE(fine.sound()) << fine.summary();
  EXPECT_EQ(fine.mixed_triangles, 1u);
  EXPECT_EQ(check_mesh(two_triangles(terrain), terrain, 1, 226, options).coarse_outline, 1u);
}

TEST(Oracle, SeesIsolatedSamplesAsNotCovered) {
  Terrain terrain = plane(9, 9);
  for (std::size_t i = 0; i < terrain.valid.size(); ++i) terrain.valid[i] = i % 2;
  Mesh nothing;
  nothing.region = all_of(terrain);
  const auto report = check_mesh(nothing, terrain, 1, 0);
  EXPECT_EQ(report.covered_samples, 0u);
  EXPECT_TRUE(report.sound()) << report.summary();
}

TEST(Oracle, FlagsAnEmptyMeshOverData) {
  const Terrain terrain = plane(3, 3);
  Mesh nothing;
  nothing.region = all_of(terrain);
  const auto report = check_mesh(nothing, terrain, 1, 0);
  EXPECT_EQ(report.uncovered_samples, 9u);
  EXPECT_EQ(report.uncovered_triangles, 8u);
}

TEST(Oracle, JoinsNeighboursAndFindsTheCrackBetweenThem) {
  const Terrain terrain = plane(17, 9);
  const auto half = [&](std::int32_t first, bool split) {
    Mesh mesh;  // a fan around the middle, counter-clockwise, with or without the middle of the shared side
    mesh.region = {{first, 0}, {first + 8, 8}};
    mesh.points = {{first + 4, 4}, {first, 0}, {first, 8}, {first + 8, 8}, {first + 8, 0}};
    if (split && first == 0) mesh.points.insert(mesh.points.begin() + 4, GridPoint{8, 4});
    if (split && first == 8) mesh.points.insert(mesh.points.begin() + 2, GridPoint{8, 4});
    const auto last = static_cast<std::uint32_t>(mesh.points.size() - 1);
    for (std::uint32_t i = 1; i <= last; ++i) mesh.triangles.push_back({0, i, i < last ? i + 1 : 1});
    for (const GridPoint p : mesh.points) mesh.heights.push_back(terrain.at(p.col, p.row));
    return mesh;
  };
  const GridRect both = all_of(terrain);
  for (const bool west : {false, true}) {
    for (const bool east : {false, true}) {
      const Mesh a = half(0, west), b = half(8, east);
      EXPECT_TRUE(check_mesh(a, terrain, 1, 0).sound()) << check_mesh(a, terrain, 1, 0).summary();
      EXPECT_TRUE(check_mesh(b, terrain, 1, 0).sound()) << check_mesh(b, terrain, 1, 0).summary();
      const auto report = check_mesh(join(a, b, both), terrain, 1, 0);
      EXPECT_EQ(report.sound(), west == east) << report.summary();
      EXPECT_EQ(report.t_junctions, west == east ? 0u : 1u);
    }
  }
}

}  // namespace
}  // namespace talus::support
