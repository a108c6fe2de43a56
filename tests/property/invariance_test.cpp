// What an answer may not depend on, and what follows for it as mathematics says, on random rasters of all types, voids
// included.
//
// A vertex is selected iff its error, rounded up to the ladder, exceeds the largest rung within the tolerance, or
// others or the border need it. Errors are distances between heights, sides on the ground times the void weight, and
// nothing else. So:
//
// - A constant added to all heights changes no error: the same vertices at every tolerance, heights shifted.
// - Heights, void weight and tolerance times m: errors are m times as large. Where both tolerances are rungs, the same
//   vertices. Elsewhere rounding decides, and one way only: from r for t and R for m·t, R < m·r gives more, R > m·r
//   fewer.
// - The grid transposed, or turned by 180°: the hierarchy over a square of 2^k cells that stands at the origin is
//   mapped to itself, so the same vertices, transposed or turned. A mirror turns the one hypotenuse of its middle
//   vertex, whose error is then another; all others are the same.
// - The grid moved by a multiple of 2^(k+1) cells, the raster within 2^k: spacings and diagonals are the same, so the
//   same vertices, moved. Moved by a block: the same errors of all vertices whose spacing is a quarter of it or less.
//
// All of that exactly where arithmetic is: heights in eighths, in metres. Elsewhere a computed error may be too large
// by the rounding margin, so that a vertex may go to the next rung: what is selected lies between the answers a rung to
// either side.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error/error_ladder.hpp"
#include "engine/quadtree/grid.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/random_raster.hpp"

namespace talus::support {
namespace {

class Ingested {
 public:
  Ingested(const RandomRaster& raster, const IngestOptions& more = {}) {
    IngestOptions options = more;
    options.void_weight = raster.void_weight;
    write_raster(raster.terrain, folder_ / "a.tif", raster.file);
    ingest(folder_ / "a.tif", folder_ / "a.talus", options);
    now_.emplace(Database::open(folder_ / "a.talus").snapshot());
  }
  [[nodiscard]] const Snapshot& now() const { return *now_; }
  [[nodiscard]] RestrictedQuadtree range(GridRect region, double tolerance) const {
    return now_->ask({.region = region, .tolerance = Metres{tolerance}}).quadtree;
  }

 private:
  TempFolder folder_;
  std::optional<Snapshot> now_;
};

/// A raster in metres on square cells, so that nothing but the grid tells directions apart.
RandomRaster plain_raster(std::uint64_t seed, SizeLimits limits) {
  RandomRaster raster = random_raster(seed, limits);
  raster.file.crs.clear();
  raster.file.geotransform = {0, 1, 0, 0, 0, -1};
  return raster;
}

bool is_float(const RandomRaster& raster) { return raster.file.type >= SampleType::float32; }

/// No error of it, or of it moved or multiplied a little, is rounded but to a rung.
bool is_exact(const RandomRaster& raster) {
  const auto in_eighths = [](double h) { return std::abs(h) < 1 << 18 && h * 8 == std::round(h * 8); };
  return raster.file.unit.empty() &&
         std::all_of(raster.terrain.values.begin(), raster.terrain.values.end(), in_eighths);
}

std::pair<double, double> range_of(const Terrain& terrain) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < terrain.values.size(); ++i) {
    if (terrain.valid[i] == 0) continue;
    low = std::min(low, terrain.values[i]), high = std::max(high, terrain.values[i]);
  }
  return {low, high};
}

/// What the type holds, less a value for voids, and heights within what is allowed in feet as well.
std::pair<double, double> limits_of(SampleType type) {
  switch (type) {
    case SampleType::uint8: return {1, 255};
    case SampleType::int16: return {-32767, 32767};
    case SampleType::uint16: return {1, 65535};
    case SampleType::uint32: return {1, 1e6};
    default: return {-1e6, 1e6};
  }
}

using Image = std::function<GridPoint(GridPoint)>;

GridRect image_of(GridRect r, const Image& image) {
  const GridPoint a = image(r.first), b = image(r.last);
  return {{std::min(a.col, b.col), std::min(a.row, b.row)}, {std::max(a.col, b.col), std::max(a.row, b.row)}};
}

/// Vertices of `inner` whose image is none of `outer`'s, but for one that does not count.
std::size_t missing(const RestrictedQuadtree& inner, const RestrictedQuadtree& outer, const Image& image,
                    std::optional<GridPoint> but = {}) {
  std::size_t count = 0;
  inner.vertices.for_each([&](GridPoint p) { count += p != but && !outer.vertices.contains(image(p)); });
  return count;
}

struct Expected {
  bool exact = true;
  double scale = 1, shift = 0;     ///< of heights
  std::optional<GridPoint> but{};  ///< a vertex whose error may be another
  double tolerance_scale = 1;
};

/// The answer of `other` over the image of a region is that of `one`, mapped.
void expect_image(const Ingested& one, const Ingested& other, GridRect region, double tolerance, const Image& image,
                  const Expected& expected) {
  SCOPED_TRACE(::testing::Message() << "columns " << region.first.col << " to " << region.last.col << ", rows "
                                    << region.first.row << " to " << region.last.row << " at " << tolerance << " m");
  const RestrictedQuadtree mapped = other.range(image_of(region, image), tolerance * expected.tolerance_scale);
  if (!expected.exact) {
    if (!mapped.covers.empty()) return;  // beside voids answers of different tolerance are not nested
    const ErrorCode within = largest_code_within(tolerance);
    if (within + 1 < kAlwaysSelected) {
      const RestrictedQuadtree looser = one.range(region, error_of(static_cast<ErrorCode>(within + 1)));
      EXPECT_EQ(missing(looser, mapped, image, expected.but), 0u) << "a rung looser has more";
    }
    if (within > 0) {
      const RestrictedQuadtree tighter = one.range(region, error_of(static_cast<ErrorCode>(within - 1)));
      RestrictedQuadtree as_image;
      as_image.vertices = VertexMask(mapped.vertices.region());
      tighter.vertices.for_each([&](GridPoint p) { as_image.vertices.insert(image(p)); });
      const std::optional<GridPoint> but = expected.but ? std::optional<GridPoint>(image(*expected.but)) : std::nullopt;
      EXPECT_EQ(missing(
                    mapped, as_image, [](GridPoint p) { return p; }, but),
                0u)
          << "a rung tighter has fewer";
    }
    return;
  }
  const RestrictedQuadtree answer = one.range(region, tolerance);
  EXPECT_EQ(missing(answer, mapped, image, expected.but), 0u) << "vertices are gone";
  std::size_t others = answer.vertices.size(), others_mapped = mapped.vertices.size();
  if (expected.but && region.contains(*expected.but)) {
    others -= answer.vertices.contains(*expected.but);
    others_mapped -= mapped.vertices.contains(image(*expected.but));
  }
  ASSERT_EQ(others, others_mapped) << "vertices have come";
  std::size_t wrong = 0;
  const Mesh mesh = triangulate(answer);  // vertices of no triangle have any height
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (mesh.points[i] == expected.but) continue;
    const double height = mesh.heights[i] * expected.scale + expected.shift;
    wrong += mapped.heights[mapped.vertices.rank(image(mesh.points[i]))] != height;
  }
  EXPECT_EQ(wrong, 0u) << "heights";
  EXPECT_EQ(answer.covers.empty(), mapped.covers.empty());
  EXPECT_TRUE(expected.scale != 1 || expected.but || mapped.bound == answer.bound)
      << mapped.bound.value << " and " << answer.bound.value;
}

const Image kSame = [](GridPoint p) { return p; };

/// Runs a property on random rasters; it returns whether the case was an exact one.
void for_plain_rasters(int cases, SizeLimits limits, const std::function<bool(RandomRaster, Random&)>& property) {
  const auto only = property_seed();
  int exact = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(property_cases(cases)); ++seed) {
    if (only && seed != *only) continue;
    Random random(41000 + seed);
    RandomRaster raster = plain_raster(41000 + seed, limits);
    SCOPED_TRACE("TALUS_PROPERTY_SEED=" + std::to_string(seed) + " " + raster.description);
    exact += property(std::move(raster), random), ++all;
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_TRUE(only || all < 20 || exact > all / 4) << "hardly a case was one";
}

/// k · 10^d with one digit: a rung, and so is its product with a whole number up to ten.
double random_round_tolerance(Random& random) {
  const int k = random.between(1, 9), d = random.between(-1, 3);
  return d < 0 ? k / 10.0 : k * std::pow(10.0, d);
}

TEST(Invariance, AConstantAddedChangesHeightsOnly) {
  for_plain_rasters(150, {2, 2, 140, 130}, [](RandomRaster raster, Random& random) {
    const auto [low, high] = range_of(raster.terrain);
    const auto [least, most] = limits_of(raster.file.type);
    const double from = std::max(least - low, -20000.0), to = std::min(most - high, 20000.0);
    if (!(from <= to)) return false;
    double shift = std::floor(random.within(std::ceil(from), std::floor(to)));
    if (is_float(raster)) shift += random.between(0, 7) / 8.0;
    const bool exact = is_exact(raster);
    if (!exact && raster.file.type == SampleType::float32) return false;  // the sums are rounded to floats
    RandomRaster shifted = raster;
    shifted.file.nodata.reset();
    for (double& h : shifted.terrain.values) h += shift;
    const Ingested one(raster), other(shifted);
    for (int i = 0; i < 3; ++i) {
      const GridRect region = random_region(random, raster.terrain);
      expect_image(one, other, region, random_tolerance(random), kSame, {.exact = exact, .shift = shift});
    }
    return exact;
  });
}

TEST(Invariance, HeightsWeightAndToleranceScaleTogether) {
  for_plain_rasters(150, {2, 2, 140, 130}, [](RandomRaster raster, Random& random) {
    const auto [low, high] = range_of(raster.terrain);
    const auto [least, most] = limits_of(raster.file.type);
    const int factors[] = {2, 3, 4, 5, 8, 10};
    const double m = factors[random.between(0, 5)];
    if (low * m < least || high * m > most) return false;
    const bool exact = is_exact(raster);
    if (!exact && is_float(raster) && m != 2 && m != 4 && m != 8) return false;  // the products are rounded
    RandomRaster scaled = raster;
    scaled.file.nodata.reset();
    scaled.void_weight *= m;
    for (double& h : scaled.terrain.values) h *= m;
    const Ingested one(raster), other(scaled);
    const Expected expected{.exact = exact, .scale = m, .tolerance_scale = m};
    for (int i = 0; i < 3; ++i) {
      const GridRect region = random_region(random, raster.terrain);
      expect_image(one, other, region, 0, kSame, expected);
      expect_image(one, other, region, random_round_tolerance(random), kSame, expected);
      expect_image(one, other, region, std::numeric_limits<double>::infinity(), kSame, expected);
      if (!exact || raster.terrain.has_voids()) continue;
      const double t = random.log_between(0.01, 1000);
      const double r = error_of(largest_code_within(t)), rm = error_of(largest_code_within(m * t));
      const RestrictedQuadtree a = one.range(region, t), b = other.range(region, m * t);
      if (rm >= m * r) {
        EXPECT_EQ(missing(b, a, kSame), 0u) << "more at " << t << " m";
      }
      if (rm <= m * r) {
        EXPECT_EQ(missing(a, b, kSame), 0u) << "fewer at " << t << " m";
      }
    }
    return exact;
  });
}

TEST(Invariance, MirrorsAndTurnsOfTheRootMapAnswers) {
  constexpr int kSide = 64;
  const std::pair<const char*, Image> images[] = {{"transposed",
                                                   [](GridPoint p) {
                                                     return GridPoint{p.row, p.col};
                                                   }},
                                                  {"turned by 180 degrees",
                                                   [](GridPoint p) {
                                                     return GridPoint{kSide - p.col, kSide - p.row};
                                                   }},
                                                  {"transposed and turned",
                                                   [](GridPoint p) {
                                                     return GridPoint{kSide - p.row, kSide - p.col};
                                                   }},
                                                  {"mirrored east to west",
                                                   [](GridPoint p) {
                                                     return GridPoint{kSide - p.col, p.row};
                                                   }},
                                                  {"mirrored north to south", [](GridPoint p) {
                                                     return GridPoint{p.col, kSide - p.row};
                                                   }}};
  for_plain_rasters(60, {kSide + 1, kSide + 1, kSide + 1, kSide + 1}, [&](RandomRaster raster, Random& random) {
    const Ingested one(raster);
    const bool exact = is_exact(raster);
    for (std::size_t which = 0; which < std::size(images); ++which) {
      const auto& [name, image] = images[which];
      SCOPED_TRACE(name);
      RandomRaster mapped = raster;
      for (int row = 0; row <= kSide; ++row) {
        for (int col = 0; col <= kSide; ++col) {
          const GridPoint to = image({col, row});
          mapped.terrain.at(to.col, to.row) = raster.terrain.at(col, row);
          mapped.terrain.valid[mapped.terrain.index(to.col, to.row)] =
              raster.terrain.valid[raster.terrain.index(col, row)];
        }
      }
      const Ingested other(mapped);
      Expected expected{.exact = exact};
      if (which >= 3) expected.but = GridPoint{kSide / 2, kSide / 2};
      for (int i = 0; i < 2; ++i) {
        expect_image(one, other, random_region(random, raster.terrain), random_tolerance(random), image, expected);
      }
    }
    return exact;
  });
}

/// The same raster on the same ground, its first sample at grid point `by`.
IngestOptions moved(const Ingested& one, GridPoint by) {
  Grid grid = grid_of(one.now().description());
  grid.mapping.x0 -= by.col * grid.mapping.dx, grid.mapping.y0 -= by.row * grid.mapping.dy;
  grid.extent = {by, {by.col + grid.extent.last.col, by.row + grid.extent.last.row}};
  grid.step.reset();
  IngestOptions options;
  options.inputs.grid = grid;
  return options;
}

TEST(Invariance, MovedByTwiceItsSquareAnswersMoveAlong) {
  for (const int side : {8, 32, 64}) {
    for_plain_rasters(50, {2, 2, side + 1, side + 1}, [&](RandomRaster raster, Random& random) {
      const GridPoint by{2 * side * random.between(-3, 20), 2 * side * random.between(-3, 20)};
      SCOPED_TRACE(::testing::Message() << "by " << by.col << ", " << by.row);
      const Ingested one(raster), other(raster, moved(one, by));
      EXPECT_EQ(other.now().description().extent.first, by);
      const Image image = [&](GridPoint p) { return GridPoint{p.col + by.col, p.row + by.row}; };
      for (int i = 0; i < 3; ++i) {
        expect_image(one, other, random_region(random, raster.terrain), random_tolerance(random), image,
                     {.exact = is_exact(raster)});
      }
      return is_exact(raster);
    });
  }
}

/// Of all samples.
std::vector<double> all_errors(const Snapshot& now) {
  RestrictedQuadtree all;
  all.vertices = VertexMask(now.description().extent);
  const GridRect e = now.description().extent;
  for (std::int32_t row = e.first.row; row <= e.last.row; ++row) {
    for (std::int32_t col = e.first.col; col <= e.last.col; ++col) all.vertices.insert({col, row});
  }
  all.vertices.seal();
  return errors_of(now, all);
}

TEST(Invariance, MovedByABlockFineErrorsStay) {
  for_plain_rasters(60, {2, 2, 300, 200}, [](RandomRaster raster, Random& random) {
    if (raster.terrain.has_voids()) return false;  // pages of voids only have no errors
    const GridPoint by{64 * random.between(-5, 30), 64 * random.between(-5, 30)};
    SCOPED_TRACE(::testing::Message() << "by " << by.col << ", " << by.row);
    const Ingested one(raster), other(raster, moved(one, by));
    const std::vector<double> here = all_errors(one.now()), there = all_errors(other.now());
    const bool exact = is_exact(raster);
    for (int row = 0; row < raster.terrain.rows; ++row) {
      for (int col = 0; col < raster.terrain.cols; ++col) {
        if (spacing({col, row}) > 16) continue;
        const std::size_t i = raster.terrain.index(col, row);
        // An error that follows from the page's heights is told before it is rounded up.
        const int apart = std::abs(error_code(here[i]) - error_code(there[i]));
        EXPECT_LE(apart, exact ? 0 : 1) << col << ", " << row << ": " << here[i] << " and " << there[i] << " m";
        if (::testing::Test::HasFailure()) return exact;
      }
    }
    return exact;
  });
}

}  // namespace
}  // namespace talus::support
