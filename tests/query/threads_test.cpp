// One large question on several threads: the same answer, to the bit.

#include <gtest/gtest.h>

#include "talus/talus.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {
namespace {

TEST(Threads, ChangeNothingInALargeAnswer) {
  const TempFolder folder;
  const Terrain terrain = void_blobs(fit(fractal(1400, 1100, 3), SampleType::int16), 5, 9);
  RasterOptions file;
  file.type = SampleType::int16;
  write_raster(terrain, folder / "a.tif", file);
  IngestOptions options;
  ingest(folder / "a.tif", folder / "a.talus", options);
  options.finest_tolerance = 4;
  ingest(folder / "a.tif", folder / "kept.talus", options);
  for (const char* name : {"a.talus", "kept.talus"}) {
    const Snapshot one = Database::open(folder / name).snapshot();
    for (const GridRect region : {one.description().extent, GridRect{{17, 3}, {1333, 1001}}}) {
      for (const double tolerance : {0.0, 3.0, 40.0, 1e9}) {
        const Answer expected = one.range(region, Metres{tolerance});
        const Mesh mesh = triangulate(expected.quadtree);
        for (const int threads : {2, 3, 9, 0}) {
          const Snapshot many = Database::open(folder / name, {.threads = threads}).snapshot();
          const Answer answer = many.range(region, Metres{tolerance});
          const RestrictedQuadtree &a = answer.quadtree, &e = expected.quadtree;
          EXPECT_EQ(a.vertices.size(), e.vertices.size());
          std::size_t missing = 0;
          e.vertices.for_each([&](GridPoint p) { missing += a.vertices.contains(p) ? 0 : 1; });
          EXPECT_EQ(missing, 0u);
          EXPECT_TRUE(a.heights == e.heights && a.covers == e.covers && a.level_errors == e.level_errors);
          EXPECT_EQ(a.bound, e.bound);
          EXPECT_EQ(answer.border_vertices, expected.border_vertices);
          if (name == std::string("a.talus")) {
            EXPECT_EQ(answer.cost.pages_read, expected.cost.pages_read);
          }
          EXPECT_TRUE(triangulate(a, threads).triangles == mesh.triangles);
        }
      }
    }
  }
}

}  // namespace
}  // namespace talus::support
