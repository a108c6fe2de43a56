// A mesh has the points that its triangles use, and no others: beside voids, answers have vertices that none uses.

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/random_raster.hpp"

namespace talus::support {
namespace {

TEST(MeshPoints, AreCornersOfTrianglesEachOnce) {
  const SizeLimits limits{.least_cols = 1, .least_rows = 1, .most_cols = 300, .most_rows = 300};
  const auto one = property_seed();
  const auto cases = one ? std::uint64_t{1} : static_cast<std::uint64_t>(property_cases(120));
  const std::uint64_t first = one.value_or(81000);
  std::size_t without_use = 0, few_voids = 0;
  for (std::uint64_t seed = first; seed < first + cases; ++seed) {
    const RandomRaster raster = random_raster(seed, limits);
    SCOPED_TRACE(raster.description);
    const TempFolder folder;
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    ingest(folder / "a.tif", folder / "a.talus");
    const Snapshot now = Database::open(folder / "a.talus", {.threads = 1}).snapshot();
    Random random(seed);
    for (int i = 0; i < 12; ++i) {
      const RestrictedQuadtree quadtree =
          now.ask({.region = random_region(random, raster.terrain), .tolerance = Metres{random_tolerance(random)}})
              .quadtree;
      const Mesh mesh = triangulate(quadtree, 1);
      std::vector<std::uint8_t> used(mesh.points.size(), 0);
      for (const auto& corners : mesh.triangles) {
        for (const std::uint32_t corner : corners) {
          ASSERT_LT(corner, used.size());
          used[corner] = 1;
        }
      }
      ASSERT_EQ(std::count(used.begin(), used.end(), 0), 0);
      ASSERT_EQ(mesh.heights.size(), mesh.points.size());
      std::vector<GridPoint> vertices;
      quadtree.vertices.for_each([&](GridPoint p) { vertices.push_back(p); });
      std::size_t at = 0;  // the points are vertices, in the same order and with their heights
      for (std::size_t k = 0; k < mesh.points.size(); ++k, ++at) {
        while (at < vertices.size() && vertices[at] != mesh.points[k]) ++at;
        ASSERT_LT(at, vertices.size());
        ASSERT_EQ(mesh.heights[k], quadtree.heights[at]);
      }
      const bool has_unused = mesh.points.size() < vertices.size();
      without_use += has_unused ? 1 : 0;
      const auto mixed = std::count_if(quadtree.covers.begin(), quadtree.covers.end(), [](auto c) { return c != 15; });
      few_voids += has_unused && mixed > 0 && static_cast<std::size_t>(mixed) * 32 <= vertices.size() ? 1 : 0;
    }
  }
  if (one) return;
  EXPECT_GT(without_use, 50u);
  EXPECT_GT(few_voids, 5u) << "answers whose voids are few are looked at in another way";
}

}  // namespace
}  // namespace talus::support
