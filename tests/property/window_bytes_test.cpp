// A small window out of a large database reads little of it.

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/real_models.hpp"

namespace talus::support {
namespace {

constexpr std::int32_t side = 65;
constexpr double allowed = 0.02;  // of the bytes of all pages, hence of the file too

void expect_small_windows(const std::filesystem::path& database, const Terrain& raster) {
  const Snapshot now = Database::open(database).snapshot();
  const StorageSummary storage = now.storage();
  ASSERT_EQ(storage.file_bytes, std::filesystem::file_size(database));
  const GridRect extent = now.description().extent;
  Random random(65);
  double largest = 0;
  for (int i = 0; i < 24; ++i) {
    GridPoint first{random.between(0, extent.last.col - side + 1), random.between(0, extent.last.row - side + 1)};
    if (i == 0) first = {0, 0};
    if (i == 1) first = {extent.last.col - side + 1, extent.last.row - side + 1};
    if (i == 2) first = {extent.last.col / 2 / 512 * 512 - 32, extent.last.row / 2 / 512 * 512 - 32};  // across corners
    const GridRect window{first, {first.col + side - 1, first.row + side - 1}};
    for (const double tolerance : {0.0, 1.0, 10.0}) {
      const Answer answer = now.ask({.region = window, .tolerance = Metres{tolerance}});
      EXPECT_GT(answer.cost.pages_read, 0u);
      const double share = static_cast<double>(answer.cost.bytes_read) / static_cast<double>(storage.page_bytes);
      largest = std::max(largest, share);
      EXPECT_LT(share, allowed) << answer.cost.bytes_read << " of " << storage.page_bytes
                                << " bytes for the window at (" << first.col << ", " << first.row << ") with tolerance "
                                << tolerance;
      const auto report =
          check_mesh(triangulate(answer.quadtree), raster, now.description().metres_per_unit, tolerance);
      EXPECT_TRUE(report.sound()) << report.summary();
    }
  }
  std::printf("a window of 65 x 65 samples reads at most %.3f %% of %llu bytes\n", 100 * largest,
              static_cast<unsigned long long>(storage.page_bytes));
}

TEST(WindowBytes, AreUnderTwoPercentOfAGeneratedModel) {
  const TempFolder folder;
  const Terrain raster = fit(fractal(3601, 3601, 2, 3000), SampleType::int16);
  write_raster(raster, folder / "model.tif");
  ingest(folder / "model.tif", folder / "model.talus");
  expect_small_windows(folder / "model.talus", raster);
}

TEST(WindowBytes, AreUnderTwoPercentOfSwissGermany) {
  const TempFolder folder;
  const RealModel model = real_model("swiss_germany_3s/swiss_germany.vrt", folder);
  if (!model.file) GTEST_SKIP() << model.why_not;
  ingest(*model.file, folder / "model.talus");
  expect_small_windows(folder / "model.talus", read_raster(*model.file));
}

}  // namespace
}  // namespace talus::support
