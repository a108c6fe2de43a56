// Strips against triangulate(): a strip is walked by this file's own rules, from vertices and turns alone.

#include "talus/strip.hpp"

#include <string>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "talus/quadtree.hpp"
#include "tests/engine/random_answers.hpp"

namespace talus::support {
namespace {

/// The triangles of one run after the other: the edge to go on from is the one between the newest corner and the end
/// that the path turns to.
std::multiset<Turned> walked(const TriangleStrip& strip) {
  std::multiset<Turned> found;
  std::size_t run = 0;
  GridPoint left, right;
  for (std::size_t t = 0; t < strip.triangles(); ++t) {
    if (run < strip.runs.size() && strip.runs[run].first == t) {
      left = strip.points[strip.runs[run].left];
      right = strip.points[strip.runs[run].right];
      ++run;
    }
    const GridPoint ahead = strip.points[strip.corners[t]];
    found.insert(turned(left, right, ahead));
    if (strip.steps[t].turns_right()) {
      left = ahead;
    } else {
      right = ahead;
    }
  }
  EXPECT_EQ(run, strip.runs.size());
  return found;
}

/// As hardware does: three vertices in a row, every second time turned round, those with two equal corners left out.
std::multiset<Turned> drawn(const TriangleStrip& strip, std::span<const std::uint32_t> indices) {
  std::multiset<Turned> found;
  for (std::size_t i = 2; i < indices.size(); ++i) {
    const std::uint32_t x = indices[i - 2], y = indices[i - 1], z = indices[i];
    if (x == y || y == z || x == z) continue;
    found.insert(i % 2 == 0 ? turned(strip.points[x], strip.points[y], strip.points[z])
                            : turned(strip.points[y], strip.points[x], strip.points[z]));
  }
  return found;
}

/// Type of a triangle from its corners, by lengths.
StripType type_of(GridPoint left, GridPoint right, GridPoint ahead, bool turns_right) {
  const auto length = [](GridPoint p, GridPoint q) {
    return std::int64_t{p.col - q.col} * (p.col - q.col) + std::int64_t{p.row - q.row} * (p.row - q.row);
  };
  const std::int64_t in = length(left, right), out = length(ahead, turns_right ? right : left);
  return in > out ? StripType::c : in < out ? StripType::b : StripType::a;
}

TEST(Strip, HoldsTheTrianglesOfTheMeshEachOnce) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const RestrictedQuadtree answer = random_answer(random, random_rect(random), random.between(0, 250));
    const Mesh mesh = triangulate(answer, 1);
    const TriangleStrip strip = strip_of(answer);
    EXPECT_EQ(strip.region, mesh.region);
    EXPECT_EQ(strip.points, mesh.points);
    EXPECT_EQ(strip.heights, mesh.heights);
    EXPECT_EQ(walked(strip), turned_triangles(mesh));
    EXPECT_EQ(turned_triangles(mesh_of(strip)), turned_triangles(mesh));
    EXPECT_EQ(drawn(strip, alternating_indices(strip)), turned_triangles(mesh));
    if (HasFailure()) return;
  }
}

TEST(Strip, TypesAreThoseOfTheEdges) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const TriangleStrip strip = strip_of(random_answer(random, random_rect(random), random.between(0, 250)));
    const Mesh mesh = mesh_of(strip);
    for (std::size_t t = 0; t < strip.triangles(); ++t) {
      const auto& [left, right, ahead] = mesh.triangles[t];
      ASSERT_EQ(strip.steps[t].type(),
                type_of(mesh.points[left], mesh.points[right], mesh.points[ahead], strip.steps[t].turns_right()));
    }
  }
}

TEST(Strip, ASquareAroundTheOriginIsOneRun) {
  for (const std::int32_t side : {1, 2, 8, 64}) {
    RestrictedQuadtree answer;
    answer.vertices = VertexMask({{-side, -side}, {side, side}});
    for_each_point(answer.vertices.region(), [&](GridPoint p) { answer.vertices.insert(p); });
    answer.vertices.seal();
    answer.heights.resize(answer.vertices.size(), 1.0);
    const TriangleStrip strip = strip_of(answer);
    EXPECT_EQ(strip.triangles(), static_cast<std::size_t>(8 * side * side));
    EXPECT_EQ(strip.jumps(), 0u);
    EXPECT_EQ(strip.indices(), strip.triangles() + 2);
  }
}

TEST(Strip, SwapsAreTurnsThatRepeat) {
  Random random(11);
  const RestrictedQuadtree answer = random_answer(random, {{-30, -40}, {70, 33}}, 300);
  const TriangleStrip strip = strip_of(answer);
  std::size_t swaps = 0, run = 0;
  for (std::size_t t = 0; t < strip.triangles(); ++t) {
    const bool begins = run < strip.runs.size() && strip.runs[run].first == t;
    run += begins ? 1 : 0;
    swaps += !begins && strip.steps[t].turns_right() == strip.steps[t - 1].turns_right() ? 1 : 0;
  }
  EXPECT_EQ(strip.swaps, swaps);
  // Beside the swaps, plain strips pay at most one index for the first turn of a run and four at its beginning.
  EXPECT_LE(alternating_indices(strip).size(), strip.triangles() + strip.swaps + 5 * strip.runs.size());
}

TEST(Strip, LinesAndEmptyAnswersHaveNone) {
  for (const GridRect region : {GridRect{{4, 4}, {4, 4}}, GridRect{{0, 0}, {0, 33}}, GridRect{{-7, 3}, {20, 3}}}) {
    RestrictedQuadtree answer;
    answer.vertices = VertexMask(region);
    for (const GridPoint p : border_vertices(region, root_side(region))) answer.vertices.insert(p);
    answer.vertices.seal();
    answer.heights.resize(answer.vertices.size());
    const TriangleStrip strip = strip_of(answer);
    EXPECT_EQ(strip.triangles(), 0u);
    EXPECT_TRUE(strip.points.empty() && strip.runs.empty() && alternating_indices(strip).empty());
  }
  EXPECT_EQ(strip_of(RestrictedQuadtree{}).triangles(), 0u);
}

TEST(Strip, SetsThatAreNotClosedAreRefusedOrStayInBounds) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    RestrictedQuadtree answer;
    answer.vertices = VertexMask(random_rect(random));
    const double density = random.unit();
    for_each_point(answer.vertices.region(), [&](GridPoint p) {
      if (random.chance(density)) answer.vertices.insert(p);
    });
    answer.vertices.seal();
    answer.heights.resize(answer.vertices.size());
    try {
      const Mesh mesh = mesh_of(strip_of(answer));
      for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t) ASSERT_LT(v, mesh.points.size());
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.cause(), Cause::corrupt);
    }
  }
}

}  // namespace
}  // namespace talus::support
