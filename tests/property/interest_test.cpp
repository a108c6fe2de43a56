// Points, lines and rasters of tolerances in CRS coordinates: what they become, and the answers that come of them.

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "talus/talus.hpp"
#include "tests/support/asked.hpp"
#include "tests/support/local_tolerance.hpp"

namespace talus::support {
namespace {

/// Anywhere in the cells of a region's samples, now and then on a sample or amid two.
Place random_place(Random& random, GridRect region) {
  const auto along = [&](std::int32_t first, std::int32_t last) {
    const double v = first - 0.49 + random.unit() * (last - first + 0.98);
    const double on_half = std::round(2 * v) / 2;
    return random.chance(0.3) && on_half > first - 0.5 && on_half < last + 0.5 ? on_half : v;
  };
  return {along(region.first.col, region.last.col), along(region.first.row, region.last.row)};
}
Position position(const GridMapping& m, Place p) { return {m.x(p.col), m.y(p.row)}; }

/// How far a sample is from a place, along the farther axis; 0.5 at most if it is the nearest.
double distance(GridPoint p, Place at) { return std::max(std::abs(p.col - at.col), std::abs(p.row - at.row)); }
constexpr double kNearest = 0.5 + 1e-5;

TEST(Interest, ThePointsSamplesAreTheNearest) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    Description d;
    d.mapping = {random.log_between(1, 1e6), -random.log_between(1, 1e6), random.log_between(1e-3, 1e3),
                 -random.log_between(1e-3, 1e3)};
    const GridRect region{{random.between(-50, 0), random.between(-50, 0)},
                          {random.between(1, 60), random.between(1, 60)}};
    const Place at = random_place(random, region);
    const Position where = position(d.mapping, at);
    const std::vector<GridPoint> samples = samples_nearest(d, region, {&where, 1});
    ASSERT_EQ(samples.size(), 1u);
    EXPECT_TRUE(region.contains(samples[0]));
    EXPECT_LE(distance(samples[0], at), kNearest);
  }
  const Description plain;
  const Position amid{2.5, -3.5};
  EXPECT_EQ(samples_nearest(plain, {{0, 0}, {9, 9}}, {&amid, 1}), std::vector{(GridPoint{3, 4})}) << "east and south";
}

TEST(Interest, ALinesSamplesAreOneAStepAndTheNearestToIt) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    Description d;
    d.mapping = {random.unit() * 1000, random.unit() * 1000, random.log_between(1e-3, 1e3),
                 -random.log_between(1e-3, 1e3)};
    const GridRect region{{random.between(-50, 0), random.between(-50, 0)},
                          {random.between(1, 60), random.between(1, 60)}};
    const Place from = random_place(random, region), to = random_place(random, region);
    const std::array line{position(d.mapping, from), position(d.mapping, to)};
    const std::vector<GridPoint> samples = samples_along(d, region, line);
    SCOPED_TRACE(std::to_string(i));
    ASSERT_FALSE(samples.empty());
    EXPECT_LE(distance(samples.front(), from), kNearest);
    EXPECT_LE(distance(samples.back(), to), kNearest);
    for (std::size_t k = 1; k < samples.size(); ++k) {
      const int cols = std::abs(samples[k].col - samples[k - 1].col),
                rows = std::abs(samples[k].row - samples[k - 1].row);
      EXPECT_EQ(std::max(cols, rows), 1) << "neighbours";
    }
    // Whatever line of the grid across the longer axis is crossed, the sample next to the crossing is there.
    const bool along_cols = std::abs(to.col - from.col) >= std::abs(to.row - from.row);
    const double a = along_cols ? from.col : from.row, b = along_cols ? to.col : to.row;
    const double other_a = along_cols ? from.row : from.col, other_b = along_cols ? to.row : to.col;
    for (int v = -60; v <= 70; ++v) {
      if (v < std::min(a, b) + 1e-6 || v > std::max(a, b) - 1e-6) continue;
      const double other = other_a + (v - a) / (b - a) * (other_b - other_a);
      const auto is_there = [&](GridPoint p) {
        return (along_cols ? p.col : p.row) == v && std::abs((along_cols ? p.row : p.col) - other) <= kNearest;
      };
      EXPECT_TRUE(std::any_of(samples.begin(), samples.end(), is_there)) << v;
    }
    const double longest = std::max(std::abs(a - b), std::abs(other_a - other_b));
    EXPECT_LE(samples.size(), longest + 3) << "and no more";
    if (HasFailure()) return;
  }
}

std::string refusal(const Description& d, std::vector<Position> line) {
  try {
    static_cast<void>(samples_along(d, {{2, 3}, {8, 9}}, line));
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::invalid_argument);
    return f.what();
  }
  ADD_FAILURE() << "was taken";
  return "";
}

TEST(Interest, WhatIsNoPlaceInTheRegionIsRefusedByName) {
  const Description d;
  const auto says = [](const std::string& sentence, const std::string& part) {
    EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
  };
  says(refusal(d, {{4, -5}}), "two or more");
  says(refusal(d, {}), "two or more");
  says(refusal(d, {{4, -5}, {8.75, -9}}), "8.75, -9");
  says(refusal(d, {{1.25, -5}, {4, -4}}), "1.25, -5");
  says(refusal(d, {{4, -5}, {std::nan(""), -9}}), "nan");
  says(refusal(d, {{4, -5}, {4, std::numeric_limits<double>::infinity()}}), "inf");
  says(refusal(d, {{4, -5}, {1e300, -5}}), "1e+300");
}

TEST(Interest, PointsAndLinesAreVerticesUnlessVoid) {
  for_rasters(60, [](Asked& asked) {
    const Terrain& terrain = asked.raster.terrain;
    const Description& d = asked.now->description();
    for (int i = 0; i < 5; ++i) {
      Question q = asked.question();
      std::vector<Position> places;
      for (int k = asked.random.between(1, 5); k > 0; --k)
        places.push_back(position(d.mapping, random_place(asked.random, q.region)));
      if (asked.random.chance(0.5)) q.points = samples_nearest(d, q.region, places);
      if (places.size() > 1) {
        const std::vector<GridPoint> along = samples_along(d, q.region, places);
        q.points.insert(q.points.end(), along.begin(), along.end());
      }
      if (asked.random.chance(0.3)) q.field = patch_tolerance(q.region, 1, 1, {asked.random.log_between(0.1, 100)});
      const Answer answer = asked.now->ask(q);
      asked.expect_sound(q, answer);
      std::uint64_t voids = 0;
      for (const GridPoint p : q.points) {
        if (terrain.is_valid(p.col, p.row)) {
          EXPECT_TRUE(answer.quadtree.vertices.contains(p)) << asked.name(q) << ": " << p.col << ", " << p.row;
        } else {
          ++voids;
        }
      }
      EXPECT_EQ(answer.void_points, voids) << asked.name(q);
      Question without = q;
      without.points.clear();
      const std::uint64_t more = answer.quadtree.vertices.size() - asked.now->ask(without).quadtree.vertices.size();
      // Where whole pages are void, what points depend on there is no vertex after all.
      if (terrain.has_voids()) {
        EXPECT_GE(answer.point_vertices, more) << asked.name(q);
      } else {
        EXPECT_EQ(answer.point_vertices, more) << asked.name(q);
      }
    }
  });
}

/// By loops over all cells: the tolerance of the one that a sample lies in.
class ByCell final : public ToleranceField {
 public:
  ByCell(const Description& d, GridMapping cells, SampleWindow metres)
      : d_(d), cells_(cells), metres_(std::move(metres)) {}
  [[nodiscard]] Metres at(GridPoint p) const override {
    const double x = d_.mapping.x(p.col), y = d_.mapping.y(p.row);
    int col = metres_.region.first.col, row = metres_.region.first.row;
    while (col < metres_.region.last.col && x >= cells_.x(col + 0.5) - 1e-9 * std::abs(cells_.dx)) ++col;
    while (row < metres_.region.last.row && y <= cells_.y(row + 0.5) + 1e-9 * std::abs(cells_.dy)) ++row;
    return Metres{metres_.values[metres_.index({col, row})]};
  }
  [[nodiscard]] Metres least(GridRect r) const override {
    Metres least{std::numeric_limits<double>::infinity()};
    for (int row = r.first.row; row <= r.last.row; ++row) {
      for (int col = r.first.col; col <= r.last.col; ++col) least = std::min(least, at({col, row}));
    }
    return least;
  }

 private:
  Description d_;
  GridMapping cells_;
  SampleWindow metres_;
};

struct Cells {
  GridMapping mapping;
  SampleWindow metres;
};
/// Some that cover a region, finer or coarser than its samples, in part far beyond it.
Cells random_cells(Random& random, const GridMapping& m, GridRect region) {
  Cells cells;
  const double cols = random.log_between(0.4, 40), rows = random.chance(0.5) ? cols : random.log_between(0.4, 40);
  const double west = region.first.col + 0.9 - random.unit() * 3 * cols,
               north = region.first.row + 0.9 - random.unit() * 3 * rows;
  cells.mapping = {m.x(west + cols / 2), m.y(north + rows / 2), m.dx * cols, m.dy * rows};
  cells.metres.region = {{0, 0},
                         {std::max(0, static_cast<int>(std::ceil((region.last.col - west) / cols))),
                          std::max(0, static_cast<int>(std::ceil((region.last.row - north) / rows)))}};
  const double spread = random.log_between(1e-3, 10);
  for (std::int64_t i = cells.metres.region.samples(); i > 0; --i)
    cells.metres.values.push_back(random.chance(0.05) ? 0 : random.log_between(0.01, 100) * spread);
  cells.metres.valid.assign(cells.metres.values.size(), 1);
  return cells;
}

TEST(Interest, ARastersToleranceIsThatOfTheCellASampleLiesIn) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    Description d;
    d.mapping = {random.between(-9, 9) * 1.0, 5, 0.25, -2};
    const GridRect region{{random.between(-9, 9), random.between(-9, 9)},
                          {random.between(10, 40), random.between(10, 30)}};
    const Cells cells = random_cells(random, d.mapping, region);
    const auto field = raster_tolerance(d, region, cells.mapping, cells.metres);
    const ByCell expected(d, cells.mapping, cells.metres);
    for (int k = 0; k < 50; ++k) {
      const int col = random.between(region.first.col, region.last.col),
                row = random.between(region.first.row, region.last.row);
      const GridRect rect{{col, row}, {random.between(col, region.last.col), random.between(row, region.last.row)}};
      ASSERT_EQ(field->at({col, row}).value, expected.at({col, row}).value) << i;
      ASSERT_EQ(field->least(rect).value, expected.least(rect).value) << i;
      const GridRect larger{{col - 50, row}, {rect.last.col + 100, rect.last.row}};
      ASSERT_EQ(field->least(larger).value,
                expected.least({{region.first.col, row}, {region.last.col, rect.last.row}}).value)
          << i;
    }
    EXPECT_EQ(field->at({region.last.col + 1, region.first.row}).value, std::numeric_limits<double>::infinity());
  }
}

TEST(Interest, ARastersToleranceHoldsForEverySample) {
  for_rasters(50, [](Asked& asked) {
    const Description& d = asked.now->description();
    for (int i = 0; i < 4; ++i) {
      Question q = asked.question();
      const Cells cells = random_cells(asked.random, d.mapping, q.region);
      q.field = raster_tolerance(d, q.region, cells.mapping, cells.metres);
      const Answer answer = asked.now->ask(q);
      asked.expect_sound(q, answer);
      expect_local_tolerance(triangulate(answer.quadtree), asked.raster.terrain, d.metres_per_unit, *q.field,
                             asked.name(q));
      const ByCell by_definition(d, cells.mapping, cells.metres);
      for (int k = 0; k < 20; ++k) {
        const GridPoint p{asked.random.between(q.region.first.col, q.region.last.col),
                          asked.random.between(q.region.first.row, q.region.last.row)};
        EXPECT_EQ(q.field->at(p).value, by_definition.at(p).value) << asked.name(q);
      }
    }
  });
}

TEST(Interest, RastersOfToleranceThatDoNotFitAreRefusedByName) {
  const Description d;
  const GridRect region{{0, 0}, {9, 9}};
  const auto refused = [&](GridMapping cells, std::vector<double> values, const std::string& part) {
    SampleWindow metres{{{0, 0}, {1, 1}}, std::move(values), {1, 1, 1, 1}};
    if (std::isnan(metres.values[2])) metres.valid[2] = 0;
    try {
      static_cast<void>(raster_tolerance(d, region, cells, metres));
      ADD_FAILURE() << "was taken";
    } catch (const Failure& f) {
      EXPECT_EQ(f.cause(), Cause::invalid_argument);
      EXPECT_NE(std::string(f.what()).find(part), std::string::npos) << f.what();
    }
  };
  const GridMapping fits{2, -2, 5, -5};
  refused(fits, {1, 2, 3, -4}, "7, -7 (column 1, row 1)");
  refused(fits, {1, 2, std::nan(""), 4}, "is void");
  refused({7, -2, 5, -5}, {1, 2, 3, 4}, "do not cover");
  refused({2, -9, 5, -5}, {1, 2, 3, 4}, "do not cover");
  refused({2, -2, 3, -5}, {1, 2, 3, 4}, "do not cover");
  refused({2, -2, 5, -3}, {1, 2, 3, 4}, "do not cover");
  EXPECT_THROW(static_cast<void>(raster_tolerance(d, region, fits, {})), Failure);
}

TEST(Interest, PatchesAreAsEqualAsSamplesAllow) {
  const auto field = patch_tolerance({{10, 20}, {18, 20}}, 8, 1, {0, 1, 2, 3, 4, 5, 6, 7});
  std::set<double> seen;
  for (int col = 10; col <= 18; ++col) seen.insert(field->at({col, 20}).value);
  EXPECT_EQ(seen.size(), 8u) << "nine samples, and each of eight patches has one";
}

}  // namespace
}  // namespace talus::support
