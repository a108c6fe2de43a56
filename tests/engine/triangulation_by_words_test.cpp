// The triangulation by words, with each kernel of this machine, against the plain loop over vertices.

#include "engine/quadtree/triangulation_by_words.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/machine/instruction_set.hpp"
#include "engine/quadtree/border.hpp"
#include "engine/quadtree/triangulation_by_vertices.hpp"
#include "talus/failure.hpp"
#include "talus/quadtree.hpp"
#include "tests/engine/closed_sets.hpp"
#include "tests/support/forced_kernel.hpp"
#include "tests/support/random_raster.hpp"

namespace talus::support {
namespace {

/// Inserts what lies in the mask's rectangle of the corners of each vertex's diamond, from the finest level up.
void close(VertexMask& mask) {
  const GridRect window = mask.region();
  for (std::int32_t s = 1; s <= root_side(window); s *= 2) {
    for (const bool centres : {false, true}) {  // the corners of centres are of larger spacing
      for_each_point(window, [&](GridPoint p) {
        if (spacing(p) != s || is_centre(p) != centres || !mask.contains(p)) return;
        const Diamond d = diamond(p);
        for (const GridPoint corner : {d.apexes[0], d.apexes[1], d.ends[0], d.ends[1]}) {
          if (window.contains(corner)) mask.insert(corner);
        }
      });
    }
  }
}

void seal(RestrictedQuadtree& quadtree) {
  quadtree.vertices.seal();
  quadtree.heights.clear();
  quadtree.vertices.for_each([&](GridPoint p) { quadtree.heights.push_back(1000.0 * p.row + p.col); });
}

/// A closed set: scattered vertices of all levels, all vertices of some rectangles, and all of spacing `coarse` or
/// more.
RestrictedQuadtree random_quadtree(Random& random, GridRect window, double share, std::int32_t coarse = kRootSpacing) {
  RestrictedQuadtree quadtree;
  quadtree.vertices = VertexMask(window);
  const int coarsest = random.between(0, 8);
  for_each_point(window, [&](GridPoint p) {
    if (random.chance(share * (height_in_tree(p) > coarsest ? 0.1 : 0.4))) quadtree.vertices.insert(p);
  });
  for (int i = random.between(0, 3); i > 0; --i) {
    const GridPoint x = random_point(random, window), y = random_point(random, window);
    const GridRect all{{std::min(x.col, y.col), std::min(x.row, y.row)},
                       {std::max(x.col, y.col), std::max(x.row, y.row)}};
    if (random.chance(share)) for_each_point(all, [&](GridPoint p) { quadtree.vertices.insert(p); });
  }
  for_each_point(window, [&](GridPoint p) {
    if (spacing(p) >= coarse) quadtree.vertices.insert(p);
  });
  if (random.chance(0.5)) {
    for (const GridPoint p : border_vertices(window, root_side(window))) quadtree.vertices.insert(p);
  }
  close(quadtree.vertices);
  seal(quadtree);
  return quadtree;
}

void add_covers(Random& random, RestrictedQuadtree& quadtree) {
  const double kept = random.unit();
  quadtree.covers.resize(quadtree.vertices.size());
  for (std::uint8_t& covers : quadtree.covers) {
    unsigned bits = random.chance(kept) ? 15u : 0u;
    for (unsigned i = 0; i < 4; ++i) bits |= random.chance(kept) ? 1u << i : 0u;
    covers = static_cast<std::uint8_t>(bits);
  }
}

/// From one sample to some words wide, at any place of the grid.
GridRect random_window(Random& random) {
  constexpr std::array<std::int32_t, 14> kSides{1, 2, 3, 31, 33, 63, 64, 65, 66, 127, 128, 129, 193, 400};
  const auto side = [&] {
    return random.chance(0.5) ? kSides[static_cast<std::size_t>(random.between(0, 13))] : random.between(1, 150);
  };
  const GridPoint first = random.chance(0.5) ? GridPoint{64 * random.between(-4, 4), 64 * random.between(-4, 4)}
                                             : GridPoint{random.between(-300, 300), random.between(-300, 300)};
  return {first, {first.col + side() - 1, first.row + side() - 1}};
}

using Triangulate = void (&)(const RestrictedQuadtree&, Mesh&, int, const std::stop_token&);

/// None: refused as not closed.
std::optional<Mesh> mesh_or_refused(Triangulate triangulate, const RestrictedQuadtree& quadtree, int threads = 1) {
  Mesh mesh;
  try {
    triangulate(quadtree, mesh, threads, {});
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::corrupt);
    return std::nullopt;
  }
  return mesh;
}

/// Triangles by number, each from its least corner on: the order of corners stays, that of triangles does not count.
std::vector<std::array<std::uint32_t, 3>> sorted(const Mesh& mesh) {
  std::vector<std::array<std::uint32_t, 3>> triangles(mesh.triangles.begin(), mesh.triangles.end());
  for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

/// Returns whether the loop over vertices refuses the quadtree, too.
bool expect_the_same(const RestrictedQuadtree& quadtree, int most_threads = 1) {
  const auto plain = mesh_or_refused(detail::triangulate_by_vertices, quadtree);
  std::optional<Mesh> first;
  for (const InstructionSet set : instruction_sets_here()) {
    const ForcedKernel forced{std::string(to_string(set))};
    for (int threads = 1; threads <= most_threads; ++threads) {
      SCOPED_TRACE(std::string(to_string(set)) + ", threads: " + std::to_string(threads));
      const auto mesh = mesh_or_refused(detail::triangulate_by_words, quadtree, threads);
      EXPECT_EQ(mesh.has_value(), plain.has_value());
      if (!mesh || !plain) continue;
      EXPECT_TRUE(sorted(*mesh) == sorted(*plain));
      EXPECT_TRUE(mesh->points == plain->points && mesh->heights == plain->heights);
      if (!first) first = mesh;
      EXPECT_TRUE(mesh->triangles == first->triangles) << "the order is another one";
    }
  }
  return !plain;
}

constexpr std::array<double, 8> kShares{0, 0.0003, 0.002, 0.02, 0.1, 0.4, 0.9, 3};

TEST(TriangulationByWords, GivesTheTrianglesOfTheLoopOverVertices) {
  for (int seed = 1; seed <= property_cases(400); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    RestrictedQuadtree quadtree =
        random_quadtree(random, random_window(random), kShares[static_cast<std::size_t>(seed) % kShares.size()]);
    if (random.chance(0.3)) add_covers(random, quadtree);
    EXPECT_FALSE(expect_the_same(quadtree)) << "a closed set is refused";
    if (HasFailure()) return;
  }
}

// A segment of the kernels has 4096 columns, and a vertex of the largest spacing in it has neighbours 32 columns away.
TEST(TriangulationByWords, GivesThemInWindowsOfAnyWidth) {
  std::uint64_t seed = 0;
  for (const std::int32_t cols : {4033, 4064, 4095, 4096, 4097, 4098, 4128, 4161, 8192, 8193, 8257}) {
    for (const std::int32_t rows : {1, 2, 40, 67}) {
      SCOPED_TRACE(std::to_string(cols) + " × " + std::to_string(rows));
      Random random(++seed);
      const GridPoint first{random.between(-5000, 100), random.between(-200, 100)};
      const GridRect window{first, {first.col + cols - 1, first.row + rows - 1}};
      RestrictedQuadtree quadtree =
          random_quadtree(random, window, kShares[static_cast<std::size_t>(seed) % kShares.size()]);
      if (random.chance(0.3)) add_covers(random, quadtree);
      EXPECT_FALSE(expect_the_same(quadtree));
      if (HasFailure()) return;
    }
  }
}

// Huge tolerances on narrow strips: triangles much larger than the strip is wide.
TEST(TriangulationByWords, GivesThemInNarrowStrips) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const std::int32_t narrow = random.between(1, 70), length = random.between(500, 1500);
    const bool upright = random.chance(0.5);
    const GridPoint first{random.between(-1500, 1500), random.between(-1500, 1500)};
    const GridRect window{first,
                          {first.col + (upright ? narrow : length) - 1, first.row + (upright ? length : narrow) - 1}};
    EXPECT_FALSE(expect_the_same(random_quadtree(random, window, seed % 2 == 0 ? 0 : 0.0005)));
    if (HasFailure()) return;
  }
}

// The kernels leave vertices of spacing 64 and more to a loop.
TEST(TriangulationByWords, GivesLargeTriangles) {
  std::size_t large = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const std::int32_t unit = seed % 2 == 0 ? 64 : 1;
    const GridPoint first{unit * random.between(-512 / unit, 512 / unit),
                          unit * random.between(-512 / unit, 512 / unit)};
    const GridRect window{first, {first.col + random.between(60, 500), first.row + random.between(60, 500)}};
    const std::int32_t coarse = 1 << random.between(5, 7);
    RestrictedQuadtree quadtree = random_quadtree(random, window, seed % 3 == 0 ? 0 : 0.0002, coarse);
    if (random.chance(0.3)) add_covers(random, quadtree);
    EXPECT_FALSE(expect_the_same(quadtree));
    if (HasFailure()) return;
    const Mesh mesh = triangulate(quadtree);
    for (const auto& t : mesh.triangles) large += spacing(mesh.points[t[0]]) > 32 ? 1 : 0;  // the right angle is first
  }
  EXPECT_GT(large, 100U);
}

TEST(TriangulationByWords, ThreadsChangeNothing) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect window{{random.between(-300, 0), random.between(-300, 0)}, {300, 450}};
    RestrictedQuadtree quadtree = random_quadtree(random, window, 3);
    ASSERT_GT(quadtree.vertices.size(), std::size_t{2} << 16) << "too few for three threads";
    if (seed % 2 == 0) add_covers(random, quadtree);
    EXPECT_FALSE(expect_the_same(quadtree, 3));
  }
}

TEST(TriangulationByWords, RefusesExactlyTheSetsThatTheLoopRefuses) {
  int refused = 0, taken = 0;
  for (int seed = 1; seed <= property_cases(800); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const GridRect window = random_window(random);
    RestrictedQuadtree quadtree =
        random_quadtree(random, window, kShares[static_cast<std::size_t>(seed) % kShares.size()]);
    for (int i = random.between(1, 3); i > 0 && quadtree.vertices.size() > 0; --i) {
      std::vector<GridPoint> members;
      quadtree.vertices.for_each([&](GridPoint p) { members.push_back(p); });
      const GridPoint p = members[static_cast<std::size_t>(random.between(0, static_cast<int>(members.size()) - 1))];
      const std::int32_t bit = p.col - window.first.col;
      quadtree.vertices.row_words(p.row)[static_cast<std::size_t>(bit / 64)] &= ~(std::uint64_t{1} << bit % 64);
      seal(quadtree);
    }
    if (random.chance(0.3)) add_covers(random, quadtree);
    expect_the_same(quadtree) ? ++refused : ++taken;
    if (HasFailure()) return;
  }
  EXPECT_GT(refused, 200);
  EXPECT_GT(taken, 200);
}

TEST(TriangulationByWords, RefusesSetsAtRandomOfWhichNothingIsClosed) {
  int refused = 0;
  for (int seed = 1; seed <= property_cases(300); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    RestrictedQuadtree quadtree;
    const GridRect window = random_window(random);
    quadtree.vertices = VertexMask(window);
    const double density = random.unit();
    for_each_point(window, [&](GridPoint p) {
      if (random.chance(density)) quadtree.vertices.insert(p);
    });
    seal(quadtree);
    if (random.chance(0.3)) add_covers(random, quadtree);
    refused += expect_the_same(quadtree) ? 1 : 0;
    if (HasFailure()) return;
  }
  EXPECT_GT(refused, 100);
}

TEST(TriangulationByWords, StopsWhenAsked) {
  Random random(1);
  const RestrictedQuadtree quadtree = random_quadtree(random, {{0, 0}, {100, 100}}, 1);
  std::stop_source source;
  source.request_stop();
  Mesh mesh;
  try {
    detail::triangulate_by_words(quadtree, mesh, 1, source.get_token());
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::cancelled);
  }
}

TEST(TriangulationByWords, IsChosenForLargeQuadtreesThatAreNotNearlyEmpty) {
  const auto with = [](GridRect window, std::int32_t least_spacing) {
    RestrictedQuadtree quadtree;
    quadtree.vertices = VertexMask(window);
    for_each_point(window, [&](GridPoint p) {
      if (spacing(p) >= least_spacing) quadtree.vertices.insert(p);
    });
    seal(quadtree);
    return quadtree;
  };
  RestrictedQuadtree large = with({{-5, -5}, {500, 500}}, 1);
  EXPECT_TRUE(detail::is_worth_words(large));
  EXPECT_FALSE(detail::is_worth_words(with({{0, 0}, {30, 30}}, 1)));       // small
  EXPECT_FALSE(detail::is_worth_words(with({{0, 0}, {2100, 2100}}, 16)));  // nearly empty
  large.region = {{0, 0}, {100, 100}};
  EXPECT_FALSE(detail::is_worth_words(large));  // triangles may cross the region's sides
}

TEST(Triangulation, IntoAMeshUsesItsMemoryAndLeavesNothingOfIt) {
  Random random(3);
  const RestrictedQuadtree large = random_quadtree(random, {{-5, -5}, {500, 500}}, 3);
  const RestrictedQuadtree small = random_quadtree(random, {{7, 7}, {60, 90}}, 0.5);
  Mesh mesh;
  triangulate(large, mesh);
  const auto* const memory = mesh.triangles.data();
  mesh.cuts.push_back({1.5, 2.5});
  for (const RestrictedQuadtree* quadtree : {&small, &large}) {
    triangulate(*quadtree, mesh);
    const Mesh fresh = triangulate(*quadtree);
    EXPECT_EQ(mesh.region, fresh.region);
    EXPECT_TRUE(mesh.points == fresh.points && mesh.heights == fresh.heights && mesh.triangles == fresh.triangles);
    EXPECT_TRUE(mesh.cuts.empty());
    EXPECT_EQ(mesh.triangles.data(), memory);
  }
  triangulate(RestrictedQuadtree{}, mesh);
  EXPECT_EQ(mesh.size(), 0U);
  EXPECT_TRUE(mesh.triangles.empty() && mesh.heights.empty());
}

}  // namespace
}  // namespace talus::support
