// The promise, tried on random rasters: every covered sample within the tolerance, no cracks, nothing twice.
//
// TALUS_PROPERTY_CASES=N tries N cases where these try 1,000; TALUS_PROPERTY_SEED=S tries only what a
// failing test printed as "seed S".

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/random_raster.hpp"

namespace talus::support {
namespace {

constexpr int shards = 8;  // tests that ctest can run side by side

/// Seeds 1, 2, 3 …, dealt to the shards in turn; stops at the third failure.
template <class Try>
void try_seeds(int shard, int cases, Try&& attempt) {
  int failures = 0;
  const auto one = [&](std::uint64_t seed) {
    const int before = ::testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
    SCOPED_TRACE("TALUS_PROPERTY_SEED=" + std::to_string(seed));
    try {
      attempt(seed);
    } catch (const std::exception& failure) {
      ADD_FAILURE() << "threw: " << failure.what();
    }
    const auto* result = ::testing::UnitTest::GetInstance()->current_test_info()->result();
    if (result->total_part_count() != before) ++failures;
  };
  if (const auto seed = property_seed()) {
    if (shard == 0) one(*seed);
    return;
  }
  for (int i = shard; i < cases && failures < 3; i += shards) one(static_cast<std::uint64_t>(i) + 1);
}

/// A raster, its file, its database and a view of it.
struct Ingested {
  RandomRaster raster;
  TempFolder folder;
  IngestReport report;
  Snapshot now;

  explicit Ingested(RandomRaster made) : raster(std::move(made)), report(make()), now(open()) {}

  [[nodiscard]] GridRect extent() const { return {{0, 0}, {raster.terrain.cols - 1, raster.terrain.rows - 1}}; }
  [[nodiscard]] double unit() const { return now.description().metres_per_unit; }
  [[nodiscard]] OracleReport judge(const Mesh& mesh, double tolerance) const {
    return check_mesh(mesh, raster.terrain, unit(), tolerance, raster.judging);
  }

 private:
  IngestReport make() {
    write_raster(raster.terrain, folder / "raster.tif", raster.file);
    IngestOptions options;
    options.void_weight = raster.void_weight;
    return ingest(folder / "raster.tif", folder / "raster.talus", options);
  }
  Snapshot open() { return Database::open(folder / "raster.talus").snapshot(); }
};

/// Bit for bit, voids for voids. Only the first difference is told.
::testing::AssertionResult same_samples(const SampleWindow& window, const Terrain& terrain) {
  for (std::int32_t row = window.region.first.row; row <= window.region.last.row; ++row) {
    for (std::int32_t col = window.region.first.col; col <= window.region.last.col; ++col) {
      const std::size_t got = window.index({col, row}), want = terrain.index(col, row);
      const bool same = window.valid[got] == terrain.valid[want] &&
                        (terrain.valid[want] == 0 || std::bit_cast<std::uint64_t>(window.values[got]) ==
                                                         std::bit_cast<std::uint64_t>(terrain.values[want]));
      if (same) continue;
      return ::testing::AssertionFailure()
             << "sample (" << col << ", " << row << ") is " << window.values[got] << " valid " << int{window.valid[got]}
             << ", the source has " << terrain.values[want] << " valid " << int{terrain.valid[want]};
    }
  }
  return ::testing::AssertionSuccess();
}

/// Are all vertices of `few` among those of `many`? Where there are voids, only covered samples count: a
/// coarse outline may stand on a vertex beyond the data that a fine one has no use for.
::testing::AssertionResult holds_all(const Terrain& terrain, const RestrictedQuadtree& many,
                                     const RestrictedQuadtree& few) {
  const bool voids = terrain.has_voids();
  auto outcome = ::testing::AssertionSuccess();
  few.vertices.for_each([&](GridPoint p) {
    if (!outcome || many.vertices.contains(p)) return;
    if (voids && !is_covered(terrain, few.vertices.region(), p)) return;
    outcome = ::testing::AssertionFailure() << "(" << p.col << ", " << p.row << ") is in the answer at "
                                            << few.tolerance.value << " m, not in that at " << many.tolerance.value;
  });
  if (outcome && !voids && few.vertices.size() > many.vertices.size()) {
    return ::testing::AssertionFailure() << few.vertices.size() << " vertices at " << few.tolerance.value << " m, "
                                         << many.vertices.size() << " at " << many.tolerance.value;
  }
  return outcome;
}

/// One answer, judged. Returns its largest true error.
double expect_promise(const Ingested& database, GridRect region, double tolerance, const Answer& answer) {
  const Mesh mesh = triangulate(answer.quadtree);
  EXPECT_EQ(mesh.region, region);
  const OracleReport report = database.judge(mesh, tolerance);
  EXPECT_TRUE(report.sound()) << "tolerance " << tolerance << ", region (" << region.first.col << ", "
                              << region.first.row << ") (" << region.last.col << ", " << region.last.row << ")\n"
                              << report.summary();
  const double rounding = report.exact ? 0 : 1e-9;
  EXPECT_EQ(answer.quadtree.tolerance.value, tolerance);
  EXPECT_LE(report.largest_error, answer.quadtree.bound.value + rounding) << "the bound is no bound";
  // What the bound may add to the tolerance: nothing for whole metres, a nanometre for floats and feet.
  const bool whole_metres = database.raster.file.type < SampleType::float32 && database.raster.file.unit.empty();
  EXPECT_LE(answer.quadtree.bound.value, tolerance + (whole_metres ? 0 : 1.01e-9));
  return report.largest_error;
}

// ---- random rasters --------------------------------------------------------------------------------

class Promise : public ::testing::TestWithParam<int> {};

TEST_P(Promise, HoldsForRandomRastersRegionsAndTolerances) {
  try_seeds(GetParam(), property_cases(1000), [](std::uint64_t seed) {
    const Ingested database(random_raster(seed));
    SCOPED_TRACE(database.raster.description);
    ASSERT_EQ(database.now.description().extent, database.extent());
    EXPECT_TRUE(same_samples(database.now.samples(database.extent()), database.raster.terrain));

    Random random(seed ^ 0x5eed);
    const GridRect region = random_region(random, database.raster.terrain);
    EXPECT_TRUE(same_samples(database.now.samples(region), database.raster.terrain));
    const double tolerance = random_tolerance(random);
    const Answer answer = database.now.ask({.region = region, .tolerance = Metres{tolerance}});
    const double error = expect_promise(database, region, tolerance, answer);

    // The error that was reached is itself a tolerance: a tie, and no reason for a vertex more or less.
    const Answer tie = database.now.ask({.region = region, .tolerance = Metres{error}});
    const double tie_error = expect_promise(database, region, error, tie);
    EXPECT_TRUE(holds_all(database.raster.terrain, tie.quadtree, answer.quadtree));
    if (tie_error > 0) {
      const double below = std::nextafter(tie_error, 0.0);
      const Answer finer = database.now.ask({.region = region, .tolerance = Metres{below}});
      expect_promise(database, region, below, finer);
      EXPECT_TRUE(holds_all(database.raster.terrain, finer.quadtree, tie.quadtree));
    }
  });
}
INSTANTIATE_TEST_SUITE_P(Shard, Promise, ::testing::Range(0, shards));

class Exactness : public ::testing::TestWithParam<int> {};

TEST_P(Exactness, ToleranceZeroRestoresEveryCoveredSample) {
  try_seeds(GetParam(), property_cases(160), [](std::uint64_t seed) {
    const Ingested database(random_raster(seed + 100000));
    SCOPED_TRACE(database.raster.description);
    Random random(seed);
    const GridRect region = random_region(random, database.raster.terrain);
    const Answer answer = database.now.ask({.region = region, .tolerance = Metres{0}});
    expect_promise(database, region, 0, answer);
  });
}
INSTANTIATE_TEST_SUITE_P(Shard, Exactness, ::testing::Range(0, shards));

class Tolerances : public ::testing::TestWithParam<int> {};

TEST_P(Tolerances, LooserOnesNeverGiveAVertexMore) {
  try_seeds(GetParam(), property_cases(160), [](std::uint64_t seed) {
    const Ingested database(random_raster(seed + 200000));
    SCOPED_TRACE(database.raster.description);
    Random random(seed);
    const GridRect region = random_region(random, database.raster.terrain);
    Answer finer = database.now.ask({.region = region, .tolerance = Metres{0}});
    for (const double tolerance : {0.01, 0.1, 0.25, 0.5, 1.0, 1.3, 2.0, 7.0, 20.0, 100.0, 1000.0, HUGE_VAL}) {
      Answer coarser = database.now.ask({.region = region, .tolerance = Metres{tolerance}});
      EXPECT_TRUE(holds_all(database.raster.terrain, finer.quadtree, coarser.quadtree));
      finer = std::move(coarser);
    }
  });
}
INSTANTIATE_TEST_SUITE_P(Shard, Tolerances, ::testing::Range(0, shards));

// ---- neighbours ------------------------------------------------------------------------------------

std::vector<std::pair<GridPoint, double>> along(const Mesh& mesh, GridRect side) {
  std::vector<std::pair<GridPoint, double>> found;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (side.contains(mesh.points[i])) found.emplace_back(mesh.points[i], mesh.heights[i]);
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.row, a.first.col) < std::pair(b.first.row, b.first.col);
  });
  return found;
}

/// Two rectangles that share a whole side, each at least 16 cells deep across it.
std::pair<GridRect, GridRect> random_neighbours(Random& random, const Terrain& terrain) {
  GridRect both = {{0, 0}, {terrain.cols - 1, terrain.rows - 1}};
  const bool beside = terrain.cols >= 33 && (terrain.rows < 33 || random.chance(0.5));
  const auto narrow = [&](std::int32_t& first, std::int32_t& last, int least) {
    const int spare = last - first - least;
    first += random.between(0, spare / 2);
    last -= random.between(0, spare / 2);
  };
  narrow(both.first.col, both.last.col, beside ? 32 : 1);
  narrow(both.first.row, both.last.row, beside ? 1 : 32);
  GridRect one = both, other = both;
  if (beside) {
    one.last.col = other.first.col = random.between(both.first.col + 16, both.last.col - 16);
  } else {
    one.last.row = other.first.row = random.between(both.first.row + 16, both.last.row - 16);
  }
  return {one, other};
}

class Neighbours : public ::testing::TestWithParam<int> {};

TEST_P(Neighbours, MeetWithoutACrack) {
  try_seeds(GetParam(), property_cases(400), [](std::uint64_t seed) {
    Random random(seed);
    const SizeLimits limits = random.chance(0.5) ? SizeLimits{33, 2, 200, 150} : SizeLimits{2, 33, 200, 150};
    const Ingested database(random_raster(seed + 300000, limits));
    SCOPED_TRACE(database.raster.description);
    const auto [one, other] = random_neighbours(random, database.raster.terrain);
    const double tolerance = random_tolerance(random);
    const Mesh a = triangulate(database.now.ask({.region = one, .tolerance = Metres{tolerance}}).quadtree);
    const Mesh b = triangulate(database.now.ask({.region = other, .tolerance = Metres{tolerance}}).quadtree);
    const GridRect side{other.first, one.last};
    const Mesh both = join(a, b, {one.first, other.last});
    const OracleReport report = database.judge(both, tolerance);
    EXPECT_TRUE(report.sound()) << "tolerance " << tolerance << ", shared side (" << side.first.col << ", "
                                << side.first.row << ") (" << side.last.col << ", " << side.last.row << ")\n"
                                << report.summary();
    if (!database.raster.terrain.has_voids()) {
      EXPECT_EQ(along(a, side), along(b, side));
    }
  });
}
INSTANTIATE_TEST_SUITE_P(Shard, Neighbours, ::testing::Range(0, shards));

// ---- samples ---------------------------------------------------------------------------------------

RandomRaster raster_of(Terrain terrain, SampleType type) {
  RandomRaster raster;
  raster.terrain = fit(std::move(terrain), type);
  raster.file.type = type;
  return raster;
}

TEST(Samples, EqualTheSourceBitForBitInEveryType) {
  for (const SampleType type : {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::int32,
                                SampleType::uint32, SampleType::float32, SampleType::float64}) {
    SCOPED_TRACE(to_string(type));
    Terrain terrain = noise(70, 45, 11, -500000, 900000);
    if (type == SampleType::uint8) terrain = noise(70, 45, 11, 1, 255);
    terrain = random_voids(terrain, 0.05, 3);
    const Ingested database(raster_of(terrain, type));
    EXPECT_TRUE(same_samples(database.now.samples(database.extent()), database.raster.terrain));
    EXPECT_EQ(database.now.description().source_type, to_string(type));
    const GridRect one{{33, 20}, {33, 20}};
    EXPECT_TRUE(same_samples(database.now.samples(one), database.raster.terrain));
  }
}

TEST(Samples, KeepTheSignOfZeroAndTheSmallestFloats) {
  for (const SampleType type : {SampleType::float32, SampleType::float64}) {
    SCOPED_TRACE(to_string(type));
    Terrain terrain = plane(40, 30, 0, 0, 0);
    Random random(9);
    const double smallest = type == SampleType::float32 ? 0x1p-149 : 0x1p-1074;
    const double special[] = {0.0, -0.0, smallest, -smallest, 0.1, 1e6, -1e6, 1.0 / 3.0, 123456.789};
    for (double& value : terrain.values) value = special[random.between(0, 8)];
    const Ingested database(raster_of(terrain, type));
    EXPECT_TRUE(same_samples(database.now.samples(database.extent()), database.raster.terrain));
    for (const double tolerance : {0.0, 1e-300, 0.05, 1000.0}) {
      expect_promise(database, database.extent(), tolerance,
                     database.now.ask({.region = database.extent(), .tolerance = Metres{tolerance}}));
    }
  }
}

TEST(Samples, KeepTheSignOfZeroAmongWholeMetres) {
  Terrain terrain = plateaus(50, 40, 10);
  for (std::size_t i = 0; i < terrain.values.size(); ++i) {
    if (i % 3 == 0) terrain.values[i] = i % 2 == 0 ? 0.0 : -0.0;
  }
  const Ingested database(raster_of(terrain, SampleType::float32));
  EXPECT_TRUE(same_samples(database.now.samples(database.extent()), database.raster.terrain));
}

TEST(Samples, AreVoidWhereTheSourceIsNaNWithoutSayingSo) {
  RandomRaster raster = raster_of(sine_hills(40, 40), SampleType::float32);
  for (const int i : {0, 41, 42, 800, 1599}) raster.terrain.values[static_cast<std::size_t>(i)] = NAN;
  const TempFolder folder;
  write_raster(raster.terrain, folder / "nan.tif", raster.file);
  for (const int i : {0, 41, 42, 800, 1599}) raster.terrain.valid[static_cast<std::size_t>(i)] = 0;
  ingest(folder / "nan.tif", folder / "nan.talus");
  const auto now = Database::open(folder / "nan.talus").snapshot();
  EXPECT_TRUE(same_samples(now.samples(now.description().extent), raster.terrain));
  EXPECT_EQ(now.description().void_samples, 5u);
  const auto report = check_mesh(now.mesh(Metres{1}), raster.terrain, 1, 1);
  EXPECT_TRUE(report.sound()) << report.summary();
}

TEST(Samples, AreScaledAndShiftedAsTheBandSays) {
  RandomRaster raster = raster_of(noise(60, 33, 4, -3000, 9000), SampleType::int16);
  raster.file.scale = 0.1;
  raster.file.offset = 1000;
  const TempFolder folder;
  write_raster(raster.terrain, folder / "scaled.tif", raster.file);
  for (double& value : raster.terrain.values) value = value * 0.1 + 1000;
  ingest(folder / "scaled.tif", folder / "scaled.talus");
  const auto now = Database::open(folder / "scaled.talus").snapshot();
  EXPECT_TRUE(same_samples(now.samples(now.description().extent), raster.terrain));
  for (const double tolerance : {0.0, 0.1, 50.0}) {
    const auto report = check_mesh(now.mesh(Metres{tolerance}), raster.terrain, 1, tolerance);
    EXPECT_TRUE(report.sound()) << report.summary();
  }
}

TEST(Samples, OfASouthUpRasterStandNorthUp) {
  RandomRaster raster = raster_of(fractal(50, 31, 8), SampleType::int16);
  raster.file.geotransform = {100, 10, 0, 2000, 0, 10};  // the first row of the file is the southernmost
  const TempFolder folder;
  write_raster(raster.terrain, folder / "south_up.tif", raster.file);
  ingest(folder / "south_up.tif", folder / "south_up.talus");
  const auto now = Database::open(folder / "south_up.talus").snapshot();
  Terrain flipped = raster.terrain;
  for (int row = 0; row < flipped.rows; ++row) {
    for (int col = 0; col < flipped.cols; ++col) flipped.at(col, row) = raster.terrain.at(col, flipped.rows - 1 - row);
  }
  EXPECT_TRUE(same_samples(now.samples(now.description().extent), flipped));
  const GridMapping mapping = now.description().mapping;
  EXPECT_EQ(mapping.dy, -10);
  EXPECT_EQ(mapping.x0, 105);
  EXPECT_EQ(mapping.y0, 2000 + 31 * 10 - 5);
}

// ---- answers known by thought ----------------------------------------------------------------------

Mesh answer_for(Terrain terrain, double tolerance) {
  const Ingested database(raster_of(std::move(terrain), SampleType::int16));
  const Answer answer = database.now.ask({.region = database.extent(), .tolerance = Metres{tolerance}});
  expect_promise(database, database.extent(), tolerance, answer);
  return triangulate(answer.quadtree);
}

TEST(Surfaces, APlaneIsTwoTriangles) {
  for (const double tolerance : {0.0, 1.0, 1000.0}) {
    EXPECT_EQ(answer_for(plane(17, 17), tolerance).triangles.size(), 2u);
    EXPECT_EQ(answer_for(plane(2, 2), tolerance).triangles.size(), 2u);
  }
}

TEST(Surfaces, ARidgeAlongTheCutIsTwoTriangles) {
  EXPECT_EQ(answer_for(diagonal_ridge(17, 17), 0).triangles.size(), 2u);
  EXPECT_GT(answer_for(cross_ridge(17, 17), 0).triangles.size(), 2u);
}

TEST(Surfaces, ASpikeCountsFromItsHeightOn) {
  const auto has_spike = [](const Mesh& mesh) {
    return std::find(mesh.points.begin(), mesh.points.end(), GridPoint{5, 9}) != mesh.points.end();
  };
  EXPECT_FALSE(has_spike(answer_for(spike(17, 17, 5, 9, 50), 50)));
  EXPECT_TRUE(has_spike(answer_for(spike(17, 17, 5, 9, 50), std::nextafter(50.0, 0.0))));
  EXPECT_FALSE(has_spike(answer_for(pit(17, 17, 5, 9, 50), 50)));
  EXPECT_TRUE(has_spike(answer_for(pit(17, 17, 5, 9, 50), 49)));
}

TEST(Surfaces, ALineOfSamplesHasNoTriangles) {
  for (const auto& [cols, rows] : {std::pair(1, 2), std::pair(2, 1), std::pair(40, 1), std::pair(1, 33)}) {
    const Ingested database(raster_of(plane(cols, rows), SampleType::int16));
    EXPECT_TRUE(same_samples(database.now.samples(database.extent()), database.raster.terrain));
    const Mesh mesh = database.now.mesh(Metres{0});
    EXPECT_TRUE(mesh.triangles.empty());
    EXPECT_TRUE(mesh.points.empty());
    EXPECT_EQ(mesh.region, database.extent());
  }
}

TEST(Surfaces, ARegionOfVoidsHasNoTriangles) {
  const Ingested database(raster_of(hole(sine_hills(64, 64), 10, 10, 50, 50), SampleType::int16));
  const Mesh mesh = triangulate(database.now.ask({.region = {{12, 15}, {48, 40}}, .tolerance = Metres{0}}).quadtree);
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_TRUE(mesh.points.empty());
}

}  // namespace
}  // namespace talus::support
