// The promise on real terrain, at the tolerances people ask for, judged sample by sample.

#include "tests/support/real_models.hpp"

#include <bit>
#include <cctype>
#include <string>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/oracle.hpp"

namespace talus::support {
namespace {

class RealModels : public ::testing::TestWithParam<const char*> {};

TEST_P(RealModels, KeepThePromise) {
  const TempFolder folder;
  const RealModel model = real_model(GetParam(), folder);
  if (!model.file) GTEST_SKIP() << model.why_not;
  const Terrain raster = read_raster(*model.file);
  ingest(*model.file, folder / "model.talus");
  const Snapshot now = Database::open(folder / "model.talus").snapshot();

  const GridRect extent = now.description().extent;
  ASSERT_EQ(extent, (GridRect{{0, 0}, {raster.cols - 1, raster.rows - 1}}));
  const SampleWindow stored = now.samples(extent);
  std::size_t different = 0;
  for (std::size_t i = 0; i < raster.values.size(); ++i) {
    const bool same = stored.valid[i] == raster.valid[i] &&
                      (raster.valid[i] == 0 || std::bit_cast<std::uint64_t>(stored.values[i]) ==
                                                   std::bit_cast<std::uint64_t>(raster.values[i]));
    different += same ? 0 : 1;
  }
  EXPECT_EQ(different, 0u) << "stored samples differ from the source";

  std::size_t vertices = ~std::size_t{0};
  for (const double tolerance : {0.0, 0.5, 1.0, 5.0, 20.0}) {
    const Answer answer = now.ask({.region = extent, .tolerance = Metres{tolerance}});
    const Mesh mesh = triangulate(answer.quadtree);
    const auto report = check_mesh(mesh, raster, now.description().metres_per_unit, tolerance);
    EXPECT_TRUE(report.sound()) << "at " << tolerance << " m: " << report.summary();
    EXPECT_LE(report.largest_error, answer.quadtree.bound.value + (report.exact ? 0 : 1e-9));
    if (!raster.has_voids()) {
      EXPECT_LE(answer.quadtree.vertices.size(), vertices);
    }
    vertices = answer.quadtree.vertices.size();
    std::printf("%s at %g m: %zu vertices, %zu triangles, largest error %.17g m\n", GetParam(), tolerance,
                mesh.points.size(), mesh.triangles.size(), report.largest_error);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, RealModels,
                         ::testing::Values("srtm3_S36E149.tif", "bigtujunga_30m_utm11.tif", "tirol5m_avaPfa.tif",
                                           "srtm3_N46E008.tif", "pysheds_dem.tif", "jacksboro"),
                         [](const auto& about) {
                           std::string name = about.param;
                           for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name;
                         });

}  // namespace
}  // namespace talus::support
