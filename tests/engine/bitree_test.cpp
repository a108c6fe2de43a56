// Bitrees held against every sample, edge and point by loops that know nothing of hierarchies.

#include "talus/bitree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "engine/quadtree/border.hpp"
#include "engine/quadtree/construction.hpp"
#include "talus/failure.hpp"
#include "talus/quadtree.hpp"
#include "tests/engine/random_answers.hpp"
#include "tests/engine/terrains.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

SampleWindow window_of(const Terrain& terrain, GridPoint first = {0, 0}) {
  return {{first, {first.col + terrain.cols - 1, first.row + terrain.rows - 1}}, terrain.values, terrain.valid};
}

std::int64_t cross(GridPoint a, GridPoint b, GridPoint p) {
  return (std::int64_t{b.col} - a.col) * (std::int64_t{p.row} - a.row) -
         (std::int64_t{b.row} - a.row) * (std::int64_t{p.col} - a.col);
}

std::array<GridPoint, 3> corners_of(const Mesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.points[a], mesh.points[b], mesh.points[c]};
}

/// Corners of valid finest triangles.
std::vector<std::uint8_t> covered_samples(const SampleWindow& samples) {
  std::vector<std::uint8_t> covered(samples.valid.size(), 0);
  for_each_point({samples.region.first, {samples.region.last.col - 1, samples.region.last.row - 1}}, [&](GridPoint p) {
    const bool falls = ((p.col + p.row) & 1) == 0;
    const GridPoint nw = p, ne{p.col + 1, p.row}, sw{p.col, p.row + 1}, se{p.col + 1, p.row + 1};
    const std::array<std::array<GridPoint, 3>, 2> both =
        falls ? std::array{std::array{nw, se, ne}, std::array{nw, se, sw}}
              : std::array{std::array{ne, sw, nw}, std::array{ne, sw, se}};
    for (const auto& t : both) {
      if (!std::all_of(t.begin(), t.end(), [&](GridPoint q) { return samples.valid[samples.index(q)] != 0; })) continue;
      for (const GridPoint q : t) covered[samples.index(q)] = 1;
    }
  });
  return covered;
}

/// Every triangle over every sample in it: the largest distance of covered ones; infinite if one is not touched.
double brute_error(const Mesh& mesh, const SampleWindow& samples) {
  const auto covered = covered_samples(samples);
  std::vector<std::uint8_t> touched(covered.size(), 0);
  long double largest = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = corners_of(mesh, t);
    const auto& ids = mesh.triangles[t];
    const auto area = static_cast<long double>(cross(a, b, c));
    for_each_point(
        {{std::min({a.col, b.col, c.col}), std::min({a.row, b.row, c.row})},
         {std::max({a.col, b.col, c.col}), std::max({a.row, b.row, c.row})}},
        [&](GridPoint p) {
          const long double wa = cross(b, c, p) / area, wb = cross(c, a, p) / area, wc = cross(a, b, p) / area;
          if (wa < 0 || wb < 0 || wc < 0 || !covered[samples.index(p)]) return;
          touched[samples.index(p)] = 1;
          const long double surface = wa * mesh.heights[ids[0]] + wb * mesh.heights[ids[1]] + wc * mesh.heights[ids[2]];
          largest = std::max(largest, std::abs(surface - samples.values[samples.index(p)]));
        });
  }
  return covered == touched || std::equal(covered.begin(), covered.end(), touched.begin(),
                                          [](auto c, auto t) { return c == 0 || t != 0; })
             ? static_cast<double>(largest)
             : kInfinity;
}

/// No grid point strictly inside an edge is a point of the mesh.
void expect_no_t_junction(const Mesh& mesh) {
  std::set<Point> points;
  for (const GridPoint p : mesh.points) EXPECT_TRUE(points.insert(key(p)).second);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corners = corners_of(mesh, t);
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint p = corners[i], q = corners[(i + 1) % 3];
      const std::int32_t steps = std::gcd(q.col - p.col, q.row - p.row);
      for (std::int32_t at = 1; at < steps; ++at) {
        const Point between{p.col + (q.col - p.col) / steps * at, p.row + (q.row - p.row) / steps * at};
        ASSERT_FALSE(points.contains(between)) << name_of(point(between)) << " on " << name_of(p) << name_of(q);
      }
    }
  }
}

/// All triangles are turned one way; each edge has one triangle on either side, or lies on the region's sides.
void expect_each_edge_has_two_sides(const Mesh& mesh, bool has_voids) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::int64_t twice_area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = corners_of(mesh, t);
    ASSERT_LT(cross(a, b, c), 0) << "triangle " << t;  // rows run south
    twice_area -= cross(a, b, c);
    const auto& ids = mesh.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(edges.emplace(ids[i], ids[(i + 1) % 3]).second);
  }
  if (has_voids) return;
  const GridRect r = mesh.region;
  EXPECT_EQ(twice_area, 2 * (r.cols() - 1) * (r.rows() - 1));
  for (const auto& [from, to] : edges) {
    if (edges.contains({to, from})) continue;
    const GridPoint p = mesh.points[from], q = mesh.points[to];
    const bool on_side = (p.col == q.col && (p.col == r.first.col || p.col == r.last.col)) ||
                         (p.row == q.row && (p.row == r.first.row || p.row == r.last.row));
    ASSERT_TRUE(on_side) << name_of(p) << name_of(q);
  }
}

/// How many triangles hold a place strictly; none if it lies on an edge. In parts of a cell.
std::optional<int> holders(const Mesh& mesh, std::int64_t col, std::int64_t row, std::int64_t parts) {
  int count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corners = corners_of(mesh, t);
    int inside = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint a = corners[i], b = corners[(i + 1) % 3];
      const std::int64_t turn =
          (std::int64_t{b.col} - a.col) * (row - parts * a.row) - (std::int64_t{b.row} - a.row) * (col - parts * a.col);
      if (turn < 0) ++inside;
      if (turn == 0 && inside == static_cast<int>(i)) {
        // on the line of a side; on the side itself if within its box
        const auto [c0, c1] = std::minmax(a.col, b.col);
        const auto [r0, r1] = std::minmax(a.row, b.row);
        if (col >= parts * c0 && col <= parts * c1 && row >= parts * r0 && row <= parts * r1) return std::nullopt;
      }
    }
    count += inside == 3 ? 1 : 0;
  }
  return count;
}

/// As hardware does.
std::multiset<Turned> drawn(const Mesh& mesh, std::span<const std::uint32_t> indices) {
  std::multiset<Turned> found;
  for (std::size_t i = 2; i < indices.size(); ++i) {
    const std::uint32_t x = indices[i - 2], y = indices[i - 1], z = indices[i];
    if (x == y || y == z || x == z) continue;
    found.insert(i % 2 == 0 ? turned(mesh.points[x], mesh.points[y], mesh.points[z])
                            : turned(mesh.points[y], mesh.points[x], mesh.points[z]));
  }
  return found;
}

struct Case {
  SampleWindow samples;
  bool has_voids = false;
  double tolerance = 0;
};

Case random_case(std::uint64_t seed, int side = 70) {
  Random random(seed);
  const auto numbers = static_cast<Numbers>(random.between(0, kNumbers - 1));
  const Terrain terrain = random_terrain(random, numbers, random.between(2, side), random.between(2, side));
  const GridPoint first =
      random.chance(0.4) ? GridPoint{0, 0} : GridPoint{random.between(-90, 40), random.between(-90, 40)};
  const double scale = numbers == Numbers::wild_whole ? 1e4 : 1;
  const double tolerance = random.chance(0.1)   ? 0
                           : random.chance(0.1) ? kInfinity
                           : random.chance(0.5) ? random.between(1, 40) * scale
                                                : random.log_between(0.01, 300) * scale;
  return {window_of(terrain, first), terrain.has_voids(), tolerance};
}

TEST(Bitree, EveryCoveredSampleLiesWithinTolerance) {
  std::size_t corrected = 0, fictitious = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const Case c = random_case(seed);
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Bitree bitree = bitree_of(c.samples, Metres{c.tolerance});
    EXPECT_LE(bitree.bound.value, c.tolerance + 5e-9);
    // Heights reach 10^9 here, where two doubles are 10^-7 apart.
    ASSERT_LE(brute_error(mesh_of(bitree), c.samples), bitree.bound.value + 1e-6 * (bitree.bound.value > c.tolerance));
    corrected += bitree.corrected;
    fictitious += bitree.fictitious();
  }
  EXPECT_GT(corrected, 0u);
  EXPECT_GT(fictitious, 0u);
}

TEST(Bitree, WithoutVerificationSamplesAreLeftOut) {
  int broken = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const Case c = random_case(seed);
    const Bitree bitree = bitree_of(c.samples, Metres{c.tolerance}, {.verified = false});
    EXPECT_EQ(bitree.corrected, 0u);
    EXPECT_EQ(bitree.bound.value, kInfinity);
    broken += brute_error(mesh_of(bitree), c.samples) > c.tolerance + 1e-6 ? 1 : 0;
  }
  EXPECT_GT(broken, 0);
}

TEST(Bitree, ItsMeshHasNoTJunctionsAndCoversTheRegionOnce) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Case c = random_case(seed);
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Mesh mesh = mesh_of(bitree_of(c.samples, Metres{c.tolerance}));
    expect_no_t_junction(mesh);
    expect_each_edge_has_two_sides(mesh, c.has_voids);
    Random random(seed);
    const std::int64_t parts = 1009;
    const GridRect r = c.samples.region;
    for (int i = 0; i < 30; ++i) {
      const std::int64_t col =
          random.between(static_cast<int>(parts) * r.first.col + 1, static_cast<int>(parts) * r.last.col - 1);
      const std::int64_t row =
          random.between(static_cast<int>(parts) * r.first.row + 1, static_cast<int>(parts) * r.last.row - 1);
      const auto count = holders(mesh, col, row, parts);
      if (!count) continue;
      ASSERT_LE(*count, 1);
      ASSERT_TRUE(*count == 1 || c.has_voids);
    }
    if (HasFatalFailure()) return;
  }
}

TEST(Bitree, StripsDrawTheTrianglesEachOnceAndTurnedAlike) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Case c = random_case(seed);
    const Mesh mesh = mesh_of(bitree_of(c.samples, Metres{c.tolerance}));
    const auto strip = alternating_indices(mesh);
    ASSERT_EQ(drawn(mesh, strip), turned_triangles(mesh));
    EXPECT_LE(strip.size(), 5 * mesh.triangles.size());
  }
}

TEST(Bitree, StripsOfAnyOrderDrawTheTrianglesToo) {
  Random random(5);
  Mesh mesh = mesh_of(bitree_of(window_of(fractal(30, 40, 7)), Metres{20}));
  for (std::size_t i = mesh.triangles.size(); i > 1; --i) {
    std::swap(mesh.triangles[i - 1],
              mesh.triangles[static_cast<std::size_t>(random.between(0, static_cast<int>(i) - 1))]);
  }
  EXPECT_EQ(drawn(mesh, alternating_indices(mesh)), turned_triangles(mesh));
  EXPECT_TRUE(alternating_indices(Mesh{}).empty());
}

TEST(Bitree, FictitiousVerticesFollowFromTheSelectedOnes) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Case c = random_case(seed);
    const Bitree whole = bitree_of(c.samples, Metres{c.tolerance});
    VertexMask selected(whole.region);
    std::vector<double> heights;
    whole.vertices.for_each([&](GridPoint p) {
      const std::uint32_t i = whole.vertices.rank(p);
      if ((whole.kinds[i] & Bitree::kSelected) == 0) return;
      selected.insert(p);
      heights.push_back(whole.heights[i]);
    });
    selected.seal();
    const Bitree again = complete_bitree(selected, heights);
    EXPECT_EQ(again.kinds, whole.kinds);
    EXPECT_EQ(again.heights, whole.heights);
    EXPECT_EQ(again.selected, whole.selected);
  }
}

TEST(Bitree, WithoutVerificationItHasNoVertexThatTheRestrictedQuadtreeLacks) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Case c = random_case(seed);
    const Bitree bitree = bitree_of(c.samples, Metres{c.tolerance}, {.verified = false});
    RestrictedQuadtree quadtree;
    quadtree.vertices = VertexMask(bitree.region);
    bitree.vertices.for_each([&](GridPoint p) {
      if ((bitree.kinds[bitree.vertices.rank(p)] & Bitree::kSelected) != 0) quadtree.vertices.insert(p);
    });
    close_bottom_up(quadtree.vertices, root_side(bitree.region));
    quadtree.vertices.seal();
    bitree.vertices.for_each([&](GridPoint p) { ASSERT_TRUE(quadtree.vertices.contains(p)) << name_of(p); });
    quadtree.heights.resize(quadtree.vertices.size(), 0.0);
    if (c.has_voids) continue;
    EXPECT_LE(leaf_triangles(bitree), triangulate(quadtree, 1).triangles.size());
  }
}

TEST(Bitree, OfAPlaneIsWhatItsSidesNeed) {
  const GridRect region{{-3, 5}, {60, 44}};
  const Bitree bitree = bitree_of(window_of(plane(64, 40), region.first), Metres{0});
  EXPECT_EQ(bitree.selected, border_vertices(region, root_side(region)).size());
  EXPECT_EQ(bitree.fictitious(), 0u);
  EXPECT_EQ(bitree.corrected, 0u);
}

TEST(Bitree, ASpikeSplitsOnlyWhatItLiesIn) {
  // Above it are sixteen bisections: both triangles at the spike, and from there one chain to the root on each side.
  const Terrain terrain = spike(257, 257, 101, 57);
  const Bitree bitree = bitree_of(window_of(terrain), Metres{1});
  RestrictedQuadtree quadtree;
  quadtree.vertices = VertexMask(bitree.region);
  quadtree.vertices.insert({101, 57});
  for (const GridPoint p : border_vertices(bitree.region, 512)) quadtree.vertices.insert(p);
  close_bottom_up(quadtree.vertices, 512);
  quadtree.vertices.seal();
  // A chain falls as a ray does and a closure as a wedge; flat ground has nothing to correct.
  EXPECT_EQ(bitree.corrected, 0u);
  EXPECT_LE(bitree.vertices.size(), quadtree.vertices.size());
  EXPECT_GT(bitree.fictitious(), 0u);
  EXPECT_EQ(brute_error(mesh_of(bitree), window_of(terrain)), 0);
}

TEST(Bitree, LinesAndVoidsAloneHaveNoTriangles) {
  for (const auto& [cols, rows] : {std::pair{1, 1}, {1, 30}, {30, 1}}) {
    const Mesh mesh = mesh_of(bitree_of(window_of(plane(cols, rows), {-7, 3}), Metres{1}));
    EXPECT_TRUE(mesh.triangles.empty() && mesh.points.empty());
  }
  Terrain terrain = plane(20, 20);
  terrain.valid.assign(terrain.valid.size(), 0);
  const Bitree bitree = bitree_of(window_of(terrain), Metres{1});
  EXPECT_TRUE(mesh_of(bitree).triangles.empty());
  EXPECT_EQ(leaf_triangles(bitree), 0u);
}

TEST(Bitree, HeightsInOtherUnitsAreMeasuredInMetres) {
  const Terrain terrain = fractal(65, 65, 3);
  SampleWindow kilometres = window_of(terrain);
  for (double& h : kilometres.values) h /= 1024;
  const Bitree a = bitree_of(window_of(terrain), Metres{8}),
               b = bitree_of(kilometres, Metres{8}, {.metres_per_unit = 1024});
  EXPECT_EQ(a.kinds, b.kinds);
}

TEST(Bitree, WhatItCannotBeMadeOfIsRefused) {
  const auto refused = [](const SampleWindow& samples, double tolerance, BitreeOptions options = {}) {
    try {
      (void)bitree_of(samples, Metres{tolerance}, options);
    } catch (const Failure& failure) {
      return failure.cause() == Cause::invalid_argument;
    }
    return false;
  };
  const SampleWindow good = window_of(plane(4, 4));
  EXPECT_FALSE(refused(good, 0));
  EXPECT_TRUE(refused(good, -1));
  EXPECT_TRUE(refused(good, std::nan("")));
  EXPECT_TRUE(refused(good, 1, {.metres_per_unit = 0}));
  EXPECT_TRUE(refused(good, 1, {.cell = Metres{-1}}));
  SampleWindow bad = good;
  bad.values.pop_back();
  EXPECT_TRUE(refused(bad, 1));
  bad = good;
  bad.values[3] = std::nan("");
  EXPECT_TRUE(refused(bad, 1));
  bad.valid[3] = 0;
  EXPECT_FALSE(refused(bad, 1));
  EXPECT_TRUE(refused(SampleWindow{}, 1));

  VertexMask none(good.region);
  none.seal();
  EXPECT_THROW((void)complete_bitree(none, {}), Failure);
  Bitree damaged = bitree_of(good, Metres{0});
  damaged.kinds.pop_back();
  EXPECT_THROW((void)mesh_of(damaged), Failure);
}

}  // namespace
}  // namespace talus::support
