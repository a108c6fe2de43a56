// What measure_accuracy says, held against sums over all samples that share no code with it. No time is held to
// anything.

#include "talus/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/stream.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surface_of_mesh.hpp"

namespace talus {
namespace {

using namespace support;

/// Errors by looking up the surface above each sample, whose first is grid point (0, 0).
struct PlainErrors {
  std::vector<double> all;

  void add(const Mesh& mesh, const Terrain& truth) {
    const SurfaceOfMesh surface(mesh);
    for (std::int32_t row = mesh.region.first.row; row <= mesh.region.last.row; ++row) {
      for (std::int32_t col = mesh.region.first.col; col <= mesh.region.last.col; ++col) {
        if (!truth.is_valid(col, row)) continue;
        const auto height = surface.height({double(col), double(row)});
        if (height) all.push_back(std::abs(*height - truth.at(col, row)));
      }
    }
  }
  void expect(const AccuracyErrors& found) {
    std::sort(all.begin(), all.end());
    double squares = 0;
    for (const double v : all) squares += v * v;
    EXPECT_EQ(found.samples, all.size());
    EXPECT_NEAR(found.largest.value, all.back(), 1e-9);
    EXPECT_NEAR(found.rms.value, std::sqrt(squares / static_cast<double>(all.size())), 1e-9);
    const double exact = all[static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(all.size()))) - 1];
    EXPECT_GE(found.percentile_95.value, exact - 1e-9);
    EXPECT_LE(found.percentile_95.value, exact * (1 + 1.0 / 256) + 1e-9);
  }
};

template <class T>
T middle(std::vector<T> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

class Accuracy : public ::testing::Test {
 protected:
  void make(const Terrain& terrain, const IngestOptions& options = {}) {
    raster = terrain;
    write_raster(terrain, folder / "a.tif");
    IngestOptions again = options;
    again.overwrite = true;
    ingest(folder / "a.tif", file, again);
  }
  [[nodiscard]] std::uint64_t stream_bytes(const Snapshot& now, const RestrictedQuadtree& answer) const {
    write_stream({now.description(), answer}, folder / "a.rqt");
    return std::filesystem::file_size(folder / "a.rqt");
  }
  /// Every number but times.
  void expect_as_asked(const AccuracyReport& report, const Terrain& truth) const {
    const Snapshot now = Database::open(file).snapshot();
    for (const AccuracyPoint& point : report.points) {
      SCOPED_TRACE("at " + std::to_string(point.tolerance.value));
      std::vector<std::uint64_t> vertices, triangles, bytes;
      PlainErrors errors;
      double bound = 0;
      for (const GridRect& window : report.windows) {
        const RestrictedQuadtree answer = now.ask({.region = window, .tolerance = point.tolerance}).quadtree;
        const Mesh mesh = triangulate(answer);
        vertices.push_back(mesh.points.size());
        triangles.push_back(mesh.triangles.size());
        bytes.push_back(stream_bytes(now, answer));
        bound = std::max(bound, answer.bound.value);
        errors.add(mesh, truth);
      }
      EXPECT_EQ(point.vertices, middle(vertices));
      EXPECT_EQ(point.triangles, middle(triangles));
      EXPECT_EQ(point.bytes, middle(bytes));
      EXPECT_EQ(point.most_vertices, *std::max_element(vertices.begin(), vertices.end()));
      EXPECT_EQ(point.bound.value, bound);
      EXPECT_GT(point.warm_seconds, 0);
      EXPECT_GT(point.cold_seconds, 0);
      EXPECT_LT(point.typical_window, report.windows.size());
      ASSERT_TRUE(point.errors);
      errors.expect(*point.errors);
    }
  }

  const TempFolder folder;
  const std::filesystem::path file = folder / "a.talus";
  Terrain raster;
};

TEST_F(Accuracy, EachNumberIsThatOfAskingAndOfAllSamples) {
  make(fit(fractal(150, 90, 3, 700), SampleType::int16));
  const AccuracyReport report = measure_accuracy(file);
  EXPECT_TRUE(report.is_whole);
  EXPECT_EQ(report.windows, std::vector{report.description.extent});
  EXPECT_GE(report.points.size(), 4u);
  expect_as_asked(report, raster);
}

TEST_F(Accuracy, HoldsBesideVoids) {
  make(void_blobs(random_voids(fit(fractal(120, 130, 8, 300), SampleType::int16), 0.01, 4), 6, 5));
  AccuracyOptions options;
  options.tolerances = {Metres{100}, Metres{0}, Metres{7}, Metres{7}};
  const AccuracyReport report = measure_accuracy(file, options);
  expect_as_asked(report, raster);
  EXPECT_TRUE(std::is_sorted(report.points.begin(), report.points.end(),
                             [](const auto& a, const auto& b) { return a.tolerance > b.tolerance; }));
  EXPECT_EQ(report.points.front().tolerance, Metres{100});
  EXPECT_EQ(report.points.back().tolerance, Metres{0});
  EXPECT_EQ(report.points.back().errors->largest, Metres{0});
}

TEST_F(Accuracy, IsAboutTheRegionThatWasNamed) {
  make(fit(fractal(150, 90, 3, 700), SampleType::int16));
  AccuracyOptions options;
  options.region = GridRect{{17, 5}, {100, 66}};
  const AccuracyReport report = measure_accuracy(file, options);
  EXPECT_EQ(report.windows, std::vector{*options.region});
  expect_as_asked(report, raster);
}

TEST_F(Accuracy, OfWindowsCountsAreMediansAndErrorsThoseOfAll) {
  make(hole(fit(fractal(400, 300, 9, 900), SampleType::int16), 200, 100, 260, 170));
  AccuracyOptions options;
  options.window = 65;
  options.tolerances = {Metres{50}, Metres{10}, Metres{2}};
  const AccuracyReport report = measure_accuracy(file, options);
  EXPECT_FALSE(report.is_whole);
  EXPECT_EQ(report.windows.size(), 9u);
  EXPECT_EQ(report.places, 6u * 4u);
  for (const GridRect& window : report.windows) {
    EXPECT_EQ(window.cols(), 65);
    EXPECT_EQ(window.rows(), 65);
    EXPECT_EQ(window.first.col % 64, 0);
    EXPECT_TRUE(report.description.extent.contains(window.first) && report.description.extent.contains(window.last));
    EXPECT_EQ(std::count(report.windows.begin(), report.windows.end(), window), 1);
  }
  expect_as_asked(report, raster);
}

TEST_F(Accuracy, WindowsLieWhereItIsNotFlat) {
  Terrain terrain = fit(fractal(400, 300, 9, 900), SampleType::int16);
  for (int row = 0; row < 300; ++row) {
    for (int col = 0; col < 250; ++col) terrain.at(col, row) = 0;
  }
  make(terrain);
  AccuracyOptions options;
  options.window = 33;
  options.tolerances = {Metres{10}};
  const AccuracyReport report = measure_accuracy(file, options);
  EXPECT_LT(report.places_with_terrain, report.places);
  for (const GridRect& window : report.windows) EXPECT_GE(window.last.col, 250);
}

TEST_F(Accuracy, TheStepsReachFromTheFirstVertexToTheLast) {
  make(fit(fractal(150, 90, 3, 700), SampleType::int16));
  const AccuracyReport report = measure_accuracy(file);
  const Snapshot now = Database::open(file).snapshot();
  const auto vertices = [&](double tolerance) {
    return static_cast<double>(
        now.ask({.region = report.windows.front(), .tolerance = Metres{tolerance}}).quadtree.vertices.size());
  };
  const double border = vertices(std::numeric_limits<double>::infinity()), all = vertices(0);
  EXPECT_LE(static_cast<double>(report.points.front().vertices), 0.5 * all);
  EXPECT_GE(static_cast<double>(report.points.front().vertices), border);
  EXPECT_GE(static_cast<double>(report.points.back().vertices), 0.98 * all);
  EXPECT_EQ(report.points.back().tolerance.value, 0.2);  // whole metres: halves are the least error
}

TEST_F(Accuracy, ErrorsAreAgainstTheTruthThatWasGiven) {
  make(fit(fractal(100, 90, 3, 700), SampleType::int16));
  Terrain other = raster;
  for (double& height : other.values) height += 3;
  other.make_void(40, 40);
  AccuracyOptions options;
  options.tolerances = {Metres{20}, Metres{0}};
  options.truth = [&](GridRect part) {
    SampleWindow window{part, {}, {}};
    for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
      for (std::int32_t col = part.first.col; col <= part.last.col; ++col) {
        window.values.push_back(other.at(col, row));
        window.valid.push_back(other.is_valid(col, row) ? 1 : 0);
      }
    }
    return window;
  };
  const AccuracyReport report = measure_accuracy(file, options);
  expect_as_asked(report, other);
  EXPECT_EQ(report.points.back().errors->rms, Metres{3});
}

TEST_F(Accuracy, WithoutAllSamplesErrorsAreNotKnown) {
  IngestOptions kept;
  kept.finest_tolerance = Metres{5};
  make(fit(fractal(150, 90, 3, 700), SampleType::int16), kept);
  const AccuracyReport report = measure_accuracy(file);
  EXPECT_FALSE(report.has_truth);
  EXPECT_TRUE(report.maps.empty());
  for (const AccuracyPoint& point : report.points) {
    EXPECT_FALSE(point.errors);
    EXPECT_GE(point.tolerance, Metres{5});
  }
}

TEST_F(Accuracy, TheAdviceIsAPointThatWasMeasuredWithinTheBudget) {
  make(fit(fractal(300, 300, 3, 700), SampleType::int16));
  AccuracyOptions options;
  for (const double budget : {1e-9, 1e-4, 1e-3, 1e3}) {
    options.limit_seconds = budget;
    const AccuracyReport report = measure_accuracy(file, options);
    EXPECT_EQ(report.advice.limit_seconds, budget);
    if (budget == 1e-9) {
      EXPECT_FALSE(report.advice.point);
    }
    if (budget == 1e3) {
      EXPECT_TRUE(report.advice.is_finest);
      EXPECT_EQ(report.advice.point, report.points.size() - 1);
    }
    expect_as_asked(report, raster);  // what was tried for the advice, too
  }
}

TEST_F(Accuracy, WithoutABudgetTheAdviceIsTheToleranceAmidTheOthersWhateverTimeItTook) {
  make(fit(fractal(150, 90, 3, 700), SampleType::int16));
  const AccuracyReport report = measure_accuracy(file), again = measure_accuracy(file);
  ASSERT_TRUE(report.advice.point);
  EXPECT_EQ(report.advice.point, again.advice.point);
  EXPECT_EQ(*report.advice.point, (report.points.size() - 1) / 2);
  EXPECT_EQ(report.points.size(), again.points.size()) << "nothing was tried in between";
  const AccuracyPoint& advised = report.points[*report.advice.point];
  EXPECT_GE(report.advice.limit_seconds, advised.warm_seconds);
  EXPECT_LE(report.advice.limit_seconds, 1.1 * advised.warm_seconds);
  EXPECT_FALSE(report.advice.is_finest);
}

TEST_F(Accuracy, MediansLieWithinTheMiddleHalf) {
  make(fit(fractal(150, 90, 3, 700), SampleType::int16));
  for (const AccuracyPoint& point : measure_accuracy(file).points) {
    EXPECT_GT(point.warm_low_seconds, 0);
    EXPECT_LE(point.warm_low_seconds, point.warm_seconds);
    EXPECT_LE(point.warm_seconds, point.warm_high_seconds);
  }
}

TEST_F(Accuracy, AMapHasTheFarthestSampleOfEachCellWithItsSign) {
  make(hole(fit(fractal(1000, 60, 3, 700), SampleType::int16), 30, 30, 35, 36));
  AccuracyOptions options;
  options.tolerances = {Metres{30}};
  options.map_tolerance = Metres{11};
  const AccuracyReport report = measure_accuracy(file, options);
  ASSERT_EQ(report.maps.size(), 1u);
  const ErrorMap& map = report.maps.front();
  EXPECT_EQ(map.step, 2);
  ASSERT_EQ(map.cols, 500);
  ASSERT_EQ(map.rows, 30);
  const SurfaceOfMesh surface(Database::open(file).snapshot().mesh(Metres{11}));
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      double farthest = std::numeric_limits<double>::quiet_NaN(), sum = 0;
      int count = 0;
      for (const int row : {2 * y, 2 * y + 1}) {
        for (const int col : {2 * x, 2 * x + 1}) {
          if (!raster.is_valid(col, row)) continue;
          sum += raster.at(col, row);
          ++count;
          const auto height = surface.height({double(col), double(row)});
          if (height && !(std::abs(*height - raster.at(col, row)) <= std::abs(farthest)))
            farthest = *height - raster.at(col, row);
        }
      }
      const auto at = static_cast<std::size_t>(y * map.cols + x);
      ASSERT_EQ(std::isnan(map.error_m[at]), std::isnan(farthest)) << x << " " << y;
      if (!std::isnan(farthest)) {
        ASSERT_NEAR(std::abs(map.error_m[at]), std::abs(farthest), 1e-4) << x << " " << y;
      }
      ASSERT_EQ(std::isnan(map.height_m[at]), count == 0);
      if (count > 0) {
        ASSERT_NEAR(map.height_m[at], sum / count, 1e-3);
      }
    }
  }
  EXPECT_DOUBLE_EQ(map.width.value, 999);
  EXPECT_DOUBLE_EQ(map.height.value, 59);
}

TEST_F(Accuracy, APlaneHasOneStep) {
  make(plane(100, 100));
  const AccuracyReport report = measure_accuracy(file);
  ASSERT_EQ(report.points.size(), 1u);
  EXPECT_EQ(report.points.front().errors->largest, Metres{0});
  EXPECT_TRUE(report.advice.point);
}

TEST_F(Accuracy, ProgressRisesToOne) {
  make(fit(fractal(150, 90, 3, 700), SampleType::int16));
  std::vector<double> told;
  AccuracyOptions options;
  options.progress = [&](double fraction, const char*) { told.push_back(fraction); };
  static_cast<void>(measure_accuracy(file, options));
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 1);
  EXPECT_GE(told.front(), 0);
}

TEST_F(Accuracy, WhatHasNoAnswerIsRefused) {
  make(hole(fit(fractal(150, 90, 3, 700), SampleType::int16), 0, 0, 70, 70));
  const auto cause = [&](const AccuracyOptions& options) -> std::optional<Cause> {
    try {
      static_cast<void>(measure_accuracy(file, options));
    } catch (const Failure& failure) {
      return failure.cause();
    }
    return {};
  };
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    AccuracyOptions options;
    options.tolerances = {Metres{1}, Metres{bad}};
    EXPECT_EQ(cause(options), Cause::invalid_argument) << bad;
  }
  for (const GridRect region : {GridRect{{10, 10}, {40, 40}},
                                {{0, 80}, {0, 89}},
                                {{100, 80}, {140, 80}},
                                {{140, 80}, {160, 89}},
                                {{9, 9}, {5, 5}}}) {
    AccuracyOptions options;
    options.region = region;
    EXPECT_EQ(cause(options), Cause::invalid_argument) << region.first.col << " " << region.first.row;
    options.window = 17;
    EXPECT_EQ(cause(options), Cause::invalid_argument) << region.first.col << " " << region.first.row;
  }
  for (const int side : {16, 4098, -1}) {
    AccuracyOptions options;
    options.window = side;
    EXPECT_EQ(cause(options), Cause::invalid_argument) << side;
  }
  EXPECT_THROW(static_cast<void>(measure_accuracy(folder / "none.talus")), Failure);
  make(plane(1, 1));
  EXPECT_EQ(cause({}), Cause::invalid_argument);
  make(fit(fractal(200, 1, 3, 700), SampleType::int16));
  EXPECT_EQ(cause({}), Cause::invalid_argument);
}

}  // namespace
}  // namespace talus
