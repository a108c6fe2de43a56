// The triangulation without recursion, against plain recursion from the root.

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/error/voids.hpp"
#include "engine/quadtree/border.hpp"
#include "talus/failure.hpp"
#include "talus/quadtree.hpp"
#include "tests/engine/closed_sets.hpp"

namespace talus::support {
namespace {

using Corners = std::array<Point, 3>;

Corners sorted(GridPoint a, GridPoint b, GridPoint c) {
  Corners corners{key(a), key(b), key(c)};
  std::sort(corners.begin(), corners.end());
  return corners;
}

double height_at(GridPoint p) { return 1000.0 * p.row + p.col; }

/// A set closed under parents, the part of it inside a region, and its triangles there by recursion.
struct Case {
  GridRect region;
  ClosedSet set;
  RestrictedQuadtree quadtree;
  std::multiset<Corners> expected;

  Case(Random& random, GridRect r, int points, double fine) : region(r), set(2 * root_side(r)) {
    for (const GridPoint p : border_vertices(region, set.root())) set.insert(p);
    for (int i = 0; i < points; ++i) {
      GridPoint p = random_point(random, region);
      if (!random.chance(fine)) {  // all levels, not the finest only
        const std::int32_t mask = -(1 << random.between(0, 5));
        p = {p.col & mask, p.row & mask};
        if (!region.contains(p)) continue;
      }
      set.insert(p);
    }
    quadtree.vertices = VertexMask(region);
    for (const Point& p : set.members()) {
      if (region.contains(point(p))) quadtree.vertices.insert(point(p));
    }
    // Corners of root squares are in every set.
    for_each_point(region, [&](GridPoint p) {
      if (spacing(p) >= set.root()) quadtree.vertices.insert(p);
    });
    quadtree.vertices.seal();
    quadtree.vertices.for_each([&](GridPoint p) { quadtree.heights.push_back(height_at(p)); });
    for (const Triangle& t : bisect(set)) {
      if (region.contains(t.apex) && region.contains(t.left) && region.contains(t.right)) {
        expected.insert(sorted(t.apex, t.left, t.right));
      }
    }
  }
};

std::multiset<Corners> corners_of(const Mesh& mesh) {
  std::multiset<Corners> found;
  for (const auto& t : mesh.triangles) found.insert(sorted(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
  return found;
}

void expect_well_formed(const Mesh& mesh) {
  std::set<std::uint32_t> used;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      ASSERT_LT(v, mesh.points.size());
      used.insert(v);
    }
    const GridPoint a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    // Counter-clockwise seen from above where rows run south: the usual cross product turned round.
    EXPECT_LT((b.col - a.col) * (c.row - a.row) - (b.row - a.row) * (c.col - a.col), 0);
  }
  EXPECT_EQ(used.size(), mesh.points.size()) << "points that no triangle uses";
  ASSERT_EQ(mesh.heights.size(), mesh.points.size());
  for (std::size_t i = 0; i < mesh.points.size(); ++i) EXPECT_EQ(mesh.heights[i], height_at(mesh.points[i]));
}

GridRect random_region(Random& random) {
  const GridPoint first =
      random.chance(0.3) ? GridPoint{0, 0} : GridPoint{random.between(-120, 60), random.between(-120, 60)};
  return {first, {first.col + random.between(1, 100), first.row + random.between(1, 100)}};
}

TEST(Triangulation, IsWhatRecursionFinds) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_region(random);
    const Case made(random, region, random.between(0, 200), random.unit());
    const Mesh mesh = triangulate(made.quadtree, 1);
    EXPECT_EQ(mesh.region, region);
    EXPECT_EQ(corners_of(mesh), made.expected);
    expect_well_formed(mesh);
    if (HasFailure()) return;
  }
}

TEST(Triangulation, EverySampleSelectedGivesTwoTrianglesACell) {
  const GridRect region{{-3, -70}, {67, 5}};
  RestrictedQuadtree quadtree;
  quadtree.vertices = VertexMask(region);
  for_each_point(region, [&](GridPoint p) {
    quadtree.vertices.insert(p);
    quadtree.heights.push_back(height_at(p));
  });
  quadtree.vertices.seal();
  const Mesh mesh = triangulate(quadtree, 1);
  EXPECT_EQ(mesh.points.size(), static_cast<std::size_t>(region.samples()));
  EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(2 * (region.cols() - 1) * (region.rows() - 1)));
  expect_well_formed(mesh);
}

TEST(Triangulation, EmitsOnlyTrianglesThatCoverData) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect region = random_region(random);
    Case made(random, region, random.between(0, 100), random.unit());
    // Any bits: each names one of the four triangles around a vertex.
    const double kept = random.unit();
    std::multiset<Corners> expected;
    made.quadtree.vertices.for_each([&](GridPoint p) {
      std::uint8_t bits = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        if (!random.chance(kept)) continue;
        bits = static_cast<std::uint8_t>(bits | 1u << i);
        if (spacing(p) == kRootSpacing) continue;
        const Triangle t = apex_triangles(p)[i];
        if (made.expected.contains(sorted(t.apex, t.left, t.right))) expected.insert(sorted(t.apex, t.left, t.right));
      }
      made.quadtree.covers.push_back(bits);
    });
    const Mesh mesh = triangulate(made.quadtree, 1);
    EXPECT_EQ(corners_of(mesh), expected);
    expect_well_formed(mesh);
    if (HasFailure()) return;
  }
}

// What damaged errors might select. Under the address sanitizer this also shows that nothing is written beyond its
// place.
TEST(Triangulation, ThreadsChangeNothing) {
  Random random(7);
  for (const GridRect region : {GridRect{{-3, -70}, {500, 505}}, GridRect{{64, 128}, {264, 1328}}}) {
    const Case made(random, region, 20000, 0.2);
    RestrictedQuadtree all;
    all.vertices = VertexMask(region);
    for_each_point(region, [&](GridPoint p) { all.vertices.insert(p); });
    all.vertices.seal();
    all.heights.resize(all.vertices.size(), 1.0);
    for (const RestrictedQuadtree* quadtree : {&made.quadtree, &std::as_const(all)}) {
      const Mesh one = triangulate(*quadtree, 1);
      for (const int threads : {2, 3, 7}) {
        const Mesh mesh = triangulate(*quadtree, threads);
        EXPECT_TRUE(mesh.points == one.points && mesh.heights == one.heights && mesh.triangles == one.triangles)
            << threads;
      }
    }
  }
}

TEST(Triangulation, SetsThatAreNotClosedAreRefusedOrStayInBounds) {
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const GridRect region = random_region(random);
    RestrictedQuadtree quadtree;
    quadtree.vertices = VertexMask(region);
    const double density = random.unit();
    for_each_point(region, [&](GridPoint p) {
      if (random.chance(density)) quadtree.vertices.insert(p);
    });
    quadtree.vertices.seal();
    quadtree.heights.resize(quadtree.vertices.size());
    try {
      const Mesh mesh = triangulate(quadtree, 1);
      for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t) ASSERT_LT(v, mesh.points.size());
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.cause(), Cause::corrupt);
      ++refused;
    }
  }
  EXPECT_GT(refused, 200);
}

TEST(Triangulation, ARegionOneSampleWideHasNoTriangles) {
  for (const GridRect region : {GridRect{{4, 4}, {4, 4}}, GridRect{{0, 0}, {0, 33}}, GridRect{{-7, 3}, {20, 3}}}) {
    RestrictedQuadtree quadtree;
    quadtree.vertices = VertexMask(region);
    for (const GridPoint p : border_vertices(region, root_side(region))) quadtree.vertices.insert(p);
    quadtree.vertices.seal();
    quadtree.heights.resize(quadtree.vertices.size());
    const Mesh mesh = triangulate(quadtree, 1);
    EXPECT_TRUE(mesh.triangles.empty());
    EXPECT_TRUE(mesh.points.empty());
    EXPECT_TRUE(mesh.heights.empty());
  }
}

}  // namespace
}  // namespace talus::support
