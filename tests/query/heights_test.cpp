// Heights at points, held against the raster's own samples and against the triangles of the answer.

#include <cmath>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/random_raster.hpp"
#include "tests/support/surface_of_mesh.hpp"

namespace talus {
namespace {

using namespace support;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Snapshot snapshot_of(const Terrain& terrain, const TempFolder& folder, const RasterOptions& file = {},
                     const IngestOptions& options = {}, const OpenOptions& open = {}) {
  write_raster(terrain, folder / "a.tif", file);
  IngestOptions again = options;
  again.overwrite = true;
  ingest(folder / "a.tif", folder / "a.talus", again);
  return Database::open(folder / "a.talus", open).snapshot();
}

/// Bilinear by hand, from the samples of a raster whose first one is grid point (0, 0).
std::optional<double> bilinear(const Terrain& raster, double col, double row) {
  if (!(col >= 0 && row >= 0 && col <= raster.cols - 1 && row <= raster.rows - 1)) return std::nullopt;
  double sum = 0;
  for (const int r : {static_cast<int>(std::floor(row)), static_cast<int>(std::floor(row)) + 1}) {
    for (const int c : {static_cast<int>(std::floor(col)), static_cast<int>(std::floor(col)) + 1}) {
      const double weight = (1 - std::abs(col - c)) * (1 - std::abs(row - r));
      if (weight == 0) continue;
      if (!raster.is_valid(c, r)) return std::nullopt;
      sum += weight * raster.at(c, r);
    }
  }
  return sum;
}

/// A column or row: at samples, halfway, near a line, anywhere, sometimes outside.
double random_line(Random& random, int count) {
  const double whole = random.between(0, count - 1);
  switch (random.between(0, 5)) {
    case 0:
    case 1: return whole;
    case 2: return whole + 0.5;
    case 3: return whole + random.within(-5e-7, 5e-7);
    case 4: return random.within(-1.0, count);
    default: return random.within(0.0, count - 1);
  }
}
double near_line(double v) { return std::abs(v - std::nearbyint(v)) <= 1e-6 ? std::nearbyint(v) : v; }

void expect_same(std::optional<double> found, std::optional<double> expected, double col, double row,
                 const std::string& what) {
  ASSERT_EQ(found.has_value(), expected.has_value()) << "column " << col << ", row " << row << ": " << what;
  if (found) {
    ASSERT_NEAR(*found, *expected, 1e-9 * (1 + std::abs(*expected)))
        << "column " << col << ", row " << row << ": " << what;
  }
}

TEST(Heights, AreBilinearBetweenTheSamplesOfAnyRaster) {
  const int cases = property_cases(60);
  for (int seed = 0; seed < cases; ++seed) {
    RandomRaster raster = random_raster(static_cast<std::uint64_t>(seed));
    const TempFolder folder;
    const Snapshot now = snapshot_of(raster.terrain, folder, raster.file);
    const Description& d = now.description();
    ASSERT_EQ(d.extent.cols(), raster.terrain.cols) << raster.description;
    // Scale, offset and the way the rows run are the ingest's business: the window has them.
    const SampleWindow window = now.samples(d.extent);
    Terrain truth(raster.terrain.cols, raster.terrain.rows);
    truth.values = window.values;
    truth.valid = window.valid;
    Random random(static_cast<std::uint64_t>(seed) + 77);
    const auto& [first, last] = d.extent;
    std::vector<Position> points;
    std::vector<MeshPlace> places;
    for (int i = 0; i < 300; ++i) {
      const double col = random_line(random, truth.cols), row = random_line(random, truth.rows);
      points.push_back(
          {d.mapping.x0 + (first.col + col) * d.mapping.dx, d.mapping.y0 + (first.row + row) * d.mapping.dy});
      places.push_back({near_line((points.back().x - d.mapping.x0) / d.mapping.dx) - first.col,
                        near_line((points.back().y - d.mapping.y0) / d.mapping.dy) - first.row});
    }
    std::vector<std::optional<double>> found(points.size());
    now.heights(points, found);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto expected = bilinear(truth, places[i].col, places[i].row);
      expect_same(found[i], expected, places[i].col, places[i].row, raster.description);
      if (i < 20) expect_same(now.height(points[i].x, points[i].y), found[i], places[i].col, places[i].row, "alone");
      const bool inside = places[i].col >= 0 && places[i].row >= 0 && places[i].col <= truth.cols - 1 &&
                          places[i].row <= truth.rows - 1;
      EXPECT_EQ(is_inside(now, points[i]), inside);
    }
    if (HasFatalFailure()) return;
  }
}

TEST(Heights, OnSamplesAreTheRastersOwn) {
  const Terrain terrain = fit(random_voids(fractal(300, 200, 5), 0.02, 6), SampleType::float32);
  const TempFolder folder;
  RasterOptions file;
  file.type = SampleType::float32;
  file.geotransform = {-7000.5, 0.5, 0, -900, 0, -0.5};
  const Snapshot now = snapshot_of(terrain, folder, file);
  for (int row = 0; row < terrain.rows; ++row) {
    for (int col = 0; col < terrain.cols; ++col) {
      const auto found = now.height(-7000.25 + 0.5 * col, -900.25 - 0.5 * row);
      ASSERT_EQ(found.has_value(), terrain.is_valid(col, row));
      if (found) {
        ASSERT_EQ(*found, terrain.at(col, row));
      }
    }
  }
}

TEST(Heights, OfNoNumberOrBeyondTheSamplesAreNothing) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(plane(10, 8), folder);
  EXPECT_EQ(now.height(0.5, -0.5), 100);
  for (const Position p : {Position{kNaN, -1},
                           {1, kNaN},
                           {kNaN, kNaN},
                           {INFINITY, -1},
                           {1, -INFINITY},
                           {1e300, -1},
                           {0.4, -1},
                           {9.6, -1},
                           {1, -0.4},
                           {1, -7.6}}) {
    EXPECT_EQ(now.height(p.x, p.y), std::nullopt) << p.x << " " << p.y;
    EXPECT_EQ(now.height(p.x, p.y, Metres{1}), std::nullopt) << p.x << " " << p.y;
    EXPECT_FALSE(is_inside(now, p));
  }
}

TEST(Heights, OfOneSampleAndOfOneLineAreThere) {
  for (const auto& [cols, rows] : {std::pair{1, 1}, {1, 300}, {300, 1}}) {
    const TempFolder folder;
    const Snapshot now = snapshot_of(plane(cols, rows), folder);
    EXPECT_EQ(now.height(cols - 0.5, 0.5 - rows), 100 + (cols - 1) + 2 * (rows - 1));
    EXPECT_EQ(now.height(cols - 0.5, 0.5 - rows, Metres{1}), std::nullopt) << "a line has no triangle";
    if (cols > 1) {
      EXPECT_DOUBLE_EQ(now.height(3.25, -0.5).value(), 102.75);
    }
    if (rows > 1) {
      EXPECT_DOUBLE_EQ(now.height(0.5, -3.25).value(), 105.5);
    }
  }
}

TEST(Heights, NeedOnlySamplesWithWeight) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(hole(plane(10, 10), 4, 4, 4, 4), folder);
  EXPECT_EQ(now.height(4.5, -4.5), std::nullopt);
  EXPECT_EQ(now.height(4.0, -4.5), std::nullopt);
  EXPECT_EQ(now.height(4.0, -4.0), std::nullopt);
  EXPECT_EQ(now.height(3.5, -4.5), 100 + 3 + 8);
  EXPECT_EQ(now.height(3.5, -4.0), 100 + 3 + 7);
  EXPECT_EQ(now.height(3.5 + 9e-7, -4.0), 100 + 3 + 7) << "on the line";
  EXPECT_EQ(now.height(3.5 + 2e-6, -4.0), std::nullopt) << "beside it";
}

TEST(Heights, OfASurfaceAreThoseOfTheMeshWhateverTheRaster) {
  const int cases = property_cases(60);
  for (int seed = 0; seed < cases; ++seed) {
    RandomRaster raster = random_raster(static_cast<std::uint64_t>(seed) + 1000);
    const TempFolder folder;
    IngestOptions options;
    options.void_weight = raster.void_weight;
    const Snapshot now = snapshot_of(raster.terrain, folder, raster.file, options);
    const Description& d = now.description();
    Random random(static_cast<std::uint64_t>(seed) + 7);
    for (int round = 0; round < 3; ++round) {
      const Metres tolerance{random_tolerance(random)};
      const SurfaceOfMesh surface(triangulate(now.ask({.region = d.extent, .tolerance = tolerance}).quadtree));
      std::vector<Position> points;
      std::vector<MeshPlace> places;
      for (int i = 0; i < 300; ++i) {
        const double col = random_line(random, raster.terrain.cols), row = random_line(random, raster.terrain.rows);
        points.push_back({d.mapping.x0 + (d.extent.first.col + col) * d.mapping.dx,
                          d.mapping.y0 + (d.extent.first.row + row) * d.mapping.dy});
        places.push_back({near_line((points.back().x - d.mapping.x0) / d.mapping.dx),
                          near_line((points.back().y - d.mapping.y0) / d.mapping.dy)});
      }
      std::vector<std::optional<double>> found(points.size());
      now.heights(points, found, tolerance);
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (surface.is_doubtful(places[i])) continue;
        expect_same(found[i], surface.height(places[i]), places[i].col, places[i].row,
                    raster.description + " at " + std::to_string(tolerance.value) + " m, seed " + std::to_string(seed));
      }
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(Heights, OfASurfaceAreWithinTheToleranceOfSamples) {
  const Terrain terrain = fit(fractal(700, 600, 8), SampleType::int16);
  const TempFolder folder;
  const Snapshot now = snapshot_of(terrain, folder);
  std::vector<Position> points;
  for (int row = 0; row < terrain.rows; ++row) {
    for (int col = 0; col < terrain.cols; ++col) points.push_back({col + 0.5, -0.5 - row});
  }
  std::vector<std::optional<double>> found(points.size());
  for (const double tolerance : {0.0, 0.5, 3.0, 50.0, 1e9}) {
    now.heights(points, found, Metres{tolerance});
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_TRUE(found[i]);
      ASSERT_LE(std::abs(*found[i] - terrain.values[i]), tolerance + 1e-9);
    }
  }
}

TEST(Heights, OfADatabaseOfATolerancesVerticesAreTheSurfacesOnly) {
  const Terrain terrain = fit(random_voids(fractal(500, 400, 9), 0.001, 3), SampleType::int16);
  const TempFolder folder;
  IngestOptions options;
  options.finest_tolerance = Metres{4};
  const Snapshot now = snapshot_of(terrain, folder, {}, options);
  try {
    static_cast<void>(now.height(3, -3));
    ADD_FAILURE() << "was not refused";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::unsupported);
  }
  Random random(1);
  for (const double tolerance : {1.0, 4.0, 9.0, 60.0}) {
    const SurfaceOfMesh surface(now.mesh(Metres{tolerance}));
    for (int i = 0; i < 500; ++i) {
      const MeshPlace place{random_line(random, 500), random_line(random, 400)};
      const MeshPlace snapped{near_line(place.col), near_line(place.row)};
      if (surface.is_doubtful(snapped)) continue;
      expect_same(now.height(place.col + 0.5, -0.5 - place.row, Metres{tolerance}), surface.height(snapped), place.col,
                  place.row, std::to_string(tolerance));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Heights, RefuseATolerantlessSurfaceAndTooLittleRoom) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(plane(10, 8), folder);
  EXPECT_THROW(static_cast<void>(now.height(1, -1, Metres{-1})), Failure);
  EXPECT_THROW(static_cast<void>(now.height(1, -1, Metres{kNaN})), Failure);
  const std::vector<Position> points(3);
  std::vector<std::optional<double>> room(2);
  EXPECT_THROW(now.heights(points, room), Failure);
}

TEST(Heights, ReadEachPageOnceAndTheNextTimeNone) {
  const TempFolder folder;
  const Snapshot now = snapshot_of(fit(fractal(1000, 700, 2), SampleType::int16), folder);
  Random random(3);
  std::vector<Position> points;
  for (int i = 0; i < 20000; ++i) points.push_back({random.within(0.5, 999.5), random.within(-699.5, -0.5)});
  std::vector<std::optional<double>> found(points.size()), again(points.size());
  const QueryCost first = now.heights(points, found), second = now.heights(points, again);
  EXPECT_EQ(first.pages_read, 1u + 8 * 6 + 1 + 1) << "the header, 48 pages and those above";
  EXPECT_EQ(second.pages_read, 1u);
  EXPECT_GE(second.pages_cached, 50u);
  EXPECT_EQ(found, again);
}

}  // namespace
}  // namespace talus
