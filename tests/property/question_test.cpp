// Questions beyond a rectangle and a tolerance, on rasters of every kind: each against the plain answer or by brute
// force.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "engine/error/error_ladder.hpp"
#include "engine/quadtree/grid.hpp"
#include "talus/talus.hpp"
#include "tests/support/asked.hpp"
#include "tests/support/local_tolerance.hpp"

namespace talus::support {
namespace {

using Corner = std::array<double, 3>;
using Corners = std::array<Corner, 3>;

std::multiset<Corners> triangles_of(const Mesh& mesh) {
  std::multiset<Corners> all;
  for (const auto& t : mesh.triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = {double(mesh.points[t[k]].col), double(mesh.points[t[k]].row), mesh.heights[t[k]]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.insert(corners);
  }
  return all;
}

/// Do the insides of a triangle and a rectangle meet? By cutting the triangle with the four sides.
bool share_area(const Corners& t, GridRect r) {
  std::vector<std::array<double, 2>> polygon;
  for (const Corner& c : t) polygon.push_back({c[0], c[1]});
  const auto keep = [&](auto&& inside_of) {
    std::vector<std::array<double, 2>> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const auto a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      const double da = inside_of(a), db = inside_of(b);
      if (da >= 0) kept.push_back(a);
      if ((da < 0) != (db < 0)) {
        const double f = da / (da - db);
        kept.push_back({a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])});
      }
    }
    polygon = kept;
  };
  keep([&](auto p) { return p[0] - r.first.col; });
  keep([&](auto p) { return r.last.col - p[0]; });
  keep([&](auto p) { return p[1] - r.first.row; });
  keep([&](auto p) { return r.last.row - p[1]; });
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    area += a[0] * b[1] - a[1] * b[0];
  }
  return std::abs(area) > 1e-9;
}

/// Metres from the surface, over all valid samples under it, triangle by triangle.
double largest_distance_under(const Mesh& mesh, const Terrain& terrain, double metres_per_unit) {
  double largest = 0;
  for (const auto& t : mesh.triangles) {
    const GridPoint a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    const double area = double(b.col - a.col) * (c.row - a.row) - double(b.row - a.row) * (c.col - a.col);
    for (int row = std::min({a.row, b.row, c.row}); row <= std::max({a.row, b.row, c.row}); ++row) {
      for (int col = std::min({a.col, b.col, c.col}); col <= std::max({a.col, b.col, c.col}); ++col) {
        const double u = double(b.col - col) * (c.row - row) - double(b.row - row) * (c.col - col);
        const double v = double(c.col - col) * (a.row - row) - double(c.row - row) * (a.col - col);
        const double w = area - u - v;
        if (std::min({u / area, v / area, w / area}) < 0 || terrain.valid[terrain.index(col, row)] == 0) continue;
        const double surface = (u * mesh.heights[t[0]] + v * mesh.heights[t[1]] + w * mesh.heights[t[2]]) / area;
        largest = std::max(largest, std::abs(terrain.at(col, row) - surface) * metres_per_unit);
      }
    }
  }
  return largest;
}

TEST(Ask, TheBoundOfACoverHoldsUnderAllOfIt) {
  int beyond_the_region = 0;
  for_rasters(60, [&](Asked& asked) {
    const Description& d = asked.now->description();
    for (int i = 0; i < 6; ++i) {
      Question q = asked.question();
      q.border = Border::cover;
      if (asked.random.chance(0.3)) q.max_level = asked.random.between(0, finest_level(d.extent));
      const Answer answer = asked.now->ask(q);
      const Mesh mesh = triangulate(answer.quadtree);
      const double farthest = largest_distance_under(mesh, asked.raster.terrain, d.metres_per_unit);
      const double slack =
          1e-9 + 1e-12 * std::max(std::abs(d.minimum_height), std::abs(d.maximum_height)) * d.metres_per_unit;
      EXPECT_LE(farthest, answer.quadtree.bound.value + slack) << asked.name(q);
      beyond_the_region += answer.quadtree.vertices.region() == q.region ? 0 : 1;
    }
  });
  EXPECT_TRUE(property_seed() || beyond_the_region > 0);
}

TEST(Ask, CoverGivesTheTrianglesOfTheWholeAnswerThatMeetTheRegion) {
  for_rasters(60, [](Asked& asked) {
    for (int i = 0; i < 6; ++i) {
      Question q = asked.question();
      q.border = Border::cover;
      if (asked.random.chance(0.3))
        q.max_level = asked.random.between(0, finest_level(asked.now->description().extent));
      Question whole = q;
      whole.region = asked.now->description().extent;
      whole.border = Border::constrain;
      std::multiset<Corners> expected;
      for (const Corners& t : triangles_of(triangulate(asked.now->ask(whole).quadtree))) {
        if (share_area(t, q.region)) expected.insert(t);
      }
      EXPECT_TRUE(triangles_of(triangulate(asked.now->ask(q).quadtree)) == expected) << asked.name(q);
    }
  });
}

TEST(Ask, NoLevelBeyondTheOneAskedForAndATrueBound) {
  for_rasters(60, [](Asked& asked) {
    const GridRect extent = asked.now->description().extent;
    for (int i = 0; i < 5; ++i) {
      Question q = asked.question();
      q.max_level = asked.random.between(0, finest_level(extent) + 1);
      const Answer answer = asked.now->ask(q);
      asked.expect_sound(q, answer);
      const std::int32_t finest = std::max(1, root_side(extent) >> std::min(*q.max_level + 1, 30));
      Question coarse = q;
      coarse.tolerance = Metres{std::numeric_limits<double>::infinity()};
      std::set<std::pair<int, int>> border;
      asked.now->ask({.region = q.region, .tolerance = coarse.tolerance}).quadtree.vertices.for_each([&](GridPoint p) {
        border.insert({p.col, p.row});
      });
      answer.quadtree.vertices.for_each([&](GridPoint p) {
        EXPECT_TRUE(spacing(p) >= finest || border.contains({p.col, p.row})) << asked.name(q);
      });
    }
  });
}

TEST(Ask, PointsOfInterestAreVertices) {
  for_rasters(60, [](Asked& asked) {
    for (int i = 0; i < 5; ++i) {
      Question q = asked.question();
      for (int k = asked.random.between(1, 6); k > 0; --k) {
        q.points.push_back({asked.random.between(q.region.first.col, q.region.last.col),
                            asked.random.between(q.region.first.row, q.region.last.row)});
      }
      const Answer answer = asked.now->ask(q);
      asked.expect_sound(q, answer);
      for (const GridPoint p : q.points) {
        const auto at = static_cast<std::size_t>(p.row) * static_cast<std::size_t>(asked.raster.terrain.cols) +
                        static_cast<std::size_t>(p.col);
        EXPECT_TRUE(asked.raster.terrain.valid[at] == 0 || answer.quadtree.vertices.contains(p)) << asked.name(q);
      }
    }
  });
}

class Patchwork final : public ToleranceField {
 public:
  explicit Patchwork(std::uint64_t seed) : seed_(seed) {}
  [[nodiscard]] Metres at(GridPoint p) const override {
    const auto cell = static_cast<std::uint64_t>((p.col >> 4) * 7919 + (p.row >> 4) * 104729) + seed_;
    return Metres{std::pow(2.0, double(cell * 0x9e3779b97f4a7c15ull >> 60) - 4)};
  }
  [[nodiscard]] Metres least(GridRect r) const override {
    Metres least{std::numeric_limits<double>::infinity()};
    for (int row = r.first.row >> 4; row <= r.last.row >> 4; ++row) {
      for (int col = r.first.col >> 4; col <= r.last.col >> 4; ++col) least = std::min(least, at({col * 16, row * 16}));
    }
    return least;
  }

 private:
  std::uint64_t seed_;
};

TEST(Ask, AFieldHoldsEverySampleWithinItsOwnTolerance) {
  for_rasters(50, [](Asked& asked) {
    const Description& d = asked.now->description();
    for (int i = 0; i < 4; ++i) {
      Question q = asked.question();
      const double spread = asked.random.log_between(1e-3, 10);
      std::vector<double> metres;
      const int cols = asked.random.between(1, static_cast<int>(std::min<std::int64_t>(q.region.cols(), 9)));
      const int rows = asked.random.between(1, static_cast<int>(std::min<std::int64_t>(q.region.rows(), 9)));
      for (int k = 0; k < cols * rows; ++k) metres.push_back(asked.random.log_between(0.01, 100) * spread);
      q.field = i % 2 == 0 ? patch_tolerance(q.region, cols, rows, metres)
                           : std::shared_ptr<const ToleranceField>(std::make_shared<Patchwork>(i));
      const Answer answer = asked.now->ask(q);
      asked.expect_sound(q, answer);
      expect_local_tolerance(triangulate(answer.quadtree), asked.raster.terrain, d.metres_per_unit, *q.field,
                             asked.name(q));
    }
  });
}

TEST(Ask, PatchesSayTheLeastOfARectangle) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const GridRect region{{random.between(-9, 9), random.between(-9, 9)},
                          {random.between(10, 40), random.between(10, 30)}};
    const int cols = random.between(1, static_cast<int>(std::min<std::int64_t>(7, region.cols())));
    const int rows = random.between(1, static_cast<int>(std::min<std::int64_t>(7, region.rows())));
    std::vector<double> metres;
    for (int k = 0; k < cols * rows; ++k) metres.push_back(random.unit());
    const auto field = patch_tolerance(region, cols, rows, metres);
    const int c = random.between(-12, 42), r = random.between(-12, 32);
    const GridRect rect{{c, r}, {c + random.between(0, 20), r + random.between(0, 20)}};
    double least = std::numeric_limits<double>::infinity();
    for (int y = rect.first.row; y <= rect.last.row; ++y)
      for (int x = rect.first.col; x <= rect.last.col; ++x) least = std::min(least, field->at({x, y}).value);
    EXPECT_EQ(field->least(rect).value, least);
  }
}

TEST(Ask, ABudgetsToleranceIsTheSmallestOnTheLadderThatFits) {
  for_rasters(40, [](Asked& asked) {
    for (int i = 0; i < 4; ++i) {
      const GridRect region = random_region(asked.random, asked.raster.terrain);
      const bool by_triangles = asked.random.chance(0.4);
      const auto size_at = [&](ErrorCode code) -> std::uint64_t {
        const Answer answer = asked.now->ask({.region = region, .tolerance = Metres{error_of(code)}});
        return by_triangles ? triangulate(answer.quadtree).triangles.size() : answer.quadtree.vertices.size();
      };
      const std::uint64_t least = size_at(kAlwaysSelected), most = size_at(0);
      Budget budget;
      const auto asked_for =
          static_cast<std::uint64_t>(asked.random.between(static_cast<int>(least) - 1, static_cast<int>(most) + 1));
      if (asked_for == 0) continue;
      (by_triangles ? budget.triangles : budget.vertices) = asked_for;
      if (asked_for < least) {
        EXPECT_THROW(static_cast<void>(asked.now->ask({.region = region, .budget = budget}).quadtree.tolerance),
                     Failure);
        continue;
      }
      int low = -1, high = kAlwaysSelected;  // the answer at `high` fits, at `low` it does not
      while (high - low > 1) {
        const int middle = (low + high) / 2;
        (size_at(static_cast<ErrorCode>(middle)) <= asked_for ? high : low) = middle;
      }
      EXPECT_EQ(asked.now->ask({.region = region, .budget = budget}).quadtree.tolerance.value,
                error_of(static_cast<ErrorCode>(high)))
          << asked.raster.description << ": " << asked_for << " of " << least << " to " << most
          << (by_triangles ? " triangles" : " vertices");
    }
  });
}

Mesh clipped(const Snapshot& now, Frame frame, double tolerance) {
  Question q;
  q.border = Border::clip;
  q.tolerance = Metres{tolerance};
  q.region = {{static_cast<int>(std::floor(frame.west)), static_cast<int>(std::floor(frame.north))},
              {static_cast<int>(std::ceil(frame.east)), static_cast<int>(std::ceil(frame.south))}};
  return clip_mesh(triangulate(now.ask(q).quadtree), frame);
}

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Place a = mesh.place(t[0]), b = mesh.place(t[1]), c = mesh.place(t[2]);
    const double area = (b.row - a.row) * (c.col - a.col) - (b.col - a.col) * (c.row - a.row);
    EXPECT_GE(area, -1e-9);
    sum += area / 2;
  }
  return sum;
}

/// Edges of one triangle only, by the places of their ends.
std::set<std::pair<std::array<double, 3>, std::array<double, 3>>> outline_of(const Mesh& mesh) {
  std::set<std::pair<std::array<double, 3>, std::array<double, 3>>> open;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto end = [&](std::uint32_t v) {
        return std::array{mesh.place(v).col, mesh.place(v).row, mesh.heights[v]};
      };
      const auto from = end(t[k]), to = end(t[(k + 1) % 3]);
      if (open.erase({to, from}) == 0) open.insert({from, to});
    }
  }
  return open;
}

TEST(Ask, ClippedAnswersFillTheirFramesAndMeetTheirNeighbours) {
  for_rasters(40, [](Asked& asked) {
    const Terrain& terrain = asked.raster.terrain;
    const bool has_voids = std::count(terrain.valid.begin(), terrain.valid.end(), 0) > 0;
    const double cols = terrain.cols - 1, rows = terrain.rows - 1;
    if (cols < 1 || rows < 1) return;
    for (int i = 0; i < 4; ++i) {
      const auto between = [&](double low, double high) {
        const double v = low + asked.random.unit() * (high - low);
        return asked.random.chance(0.3) ? std::clamp(std::round(v), low, high) : v;
      };
      const double tolerance = random_tolerance(asked.random);
      const double west = between(0, cols), middle = between(west, cols), east = between(middle, cols);
      const double north = between(0, rows), south = between(north, rows);
      const Frame left{west, north, middle, south}, right{middle, north, east, south};
      if (middle - west < 1e-3 || east - middle < 1e-3 || south - north < 1e-3) continue;
      const Mesh a = clipped(*asked.now, left, tolerance), b = clipped(*asked.now, right, tolerance);
      if (!has_voids) {
        EXPECT_NEAR(area_of(a), (middle - west) * (south - north), 1e-6 * cols * rows) << asked.raster.description;
        EXPECT_NEAR(area_of(b), (east - middle) * (south - north), 1e-6 * cols * rows) << asked.raster.description;
      }
      for (std::size_t v = 0; v < a.size(); ++v) {
        EXPECT_TRUE(a.place(v).col >= west && a.place(v).col <= middle && a.place(v).row >= north &&
                    a.place(v).row <= south);
      }
      // Every edge of the one on the side they share is one of the other, the other way round.
      std::set<std::pair<std::array<double, 3>, std::array<double, 3>>> on_left, on_right;
      for (const auto& [from, to] : outline_of(a))
        if (from[0] == middle && to[0] == middle) on_left.insert({from, to});
      for (const auto& [from, to] : outline_of(b))
        if (from[0] == middle && to[0] == middle) on_right.insert({to, from});
      // (Along a grid line a void may begin.)
      EXPECT_TRUE(on_left == on_right || (has_voids && middle == std::round(middle)))
          << asked.raster.description << ", side at column " << middle;
      EXPECT_TRUE(has_voids || !on_left.empty());
      // Nothing else is open inside.
      for (const auto& [from, to] : outline_of(a)) {
        const auto on = [&](double f, double t, double line) { return f == line && t == line; };
        EXPECT_TRUE(has_voids || on(from[0], to[0], west) || on(from[0], to[0], middle) || on(from[1], to[1], north) ||
                    on(from[1], to[1], south))
            << asked.raster.description;
      }
    }
  });
}

TEST(Ask, SnapGrowsToMultiplesAndEndsWithTheExtent) {
  const GridRect extent{{-30, -7}, {100, 90}};
  EXPECT_EQ(snapped({{3, 5}, {17, 32}}, 16, extent), (GridRect{{0, 0}, {32, 32}}));
  EXPECT_EQ(snapped({{-17, -3}, {-16, 0}}, 16, extent), (GridRect{{-30, -7}, {-16, 0}}));
  EXPECT_EQ(snapped({{3, 5}, {99, 89}}, 64, extent), (GridRect{{0, 0}, {100, 90}}));
  EXPECT_EQ(snapped({{3, 5}, {17, 32}}, 1, extent), (GridRect{{3, 5}, {17, 32}}));
  EXPECT_THROW(static_cast<void>(snapped({{3, 5}, {17, 32}}, 0, extent)), Failure);
}

TEST(Ask, WhatMakesNoSenseIsRefused) {
  Asked asked(1);
  const GridRect extent = asked.now->description().extent;
  const auto refused = [&](auto&& change) {
    Question q;
    q.region = extent;
    change(q);
    EXPECT_THROW(static_cast<void>(asked.now->ask(q)), Failure);
  };
  refused([](Question& q) { q.max_level = -1; });
  refused([](Question& q) { q.tolerance = Metres{-1}; });
  refused([](Question& q) { q.tolerance = Metres{std::nan("")}; });
  refused([](Question& q) { q.points.push_back({1 << 20, 0}); });
  refused([](Question& q) { q.region = {{0, 0}, {-1, 4}}; });
  refused([](Question& q) { q.border = Border::cover, q.points.push_back(q.region.first); });
  const Description& d = asked.now->description();
  const double beyond = d.mapping.x(extent.last.col + 1), y = d.mapping.y(extent.first.row);
  EXPECT_THROW(static_cast<void>(focus_tolerance(d, beyond, y, 0.1, Metres{1})), Failure);
  EXPECT_THROW(static_cast<void>(focus_tolerance(d, d.mapping.x(extent.first.col), y, -1, Metres{1})), Failure);
  EXPECT_THROW(static_cast<void>(focus_tolerance(d, std::nan(""), y, 1, Metres{1})), Failure);
  EXPECT_THROW(static_cast<void>(patch_tolerance(extent, 2, 2, {1, 2, 3})), Failure);
  EXPECT_THROW(static_cast<void>(patch_tolerance(extent, 1, 1, {-1})), Failure);
  EXPECT_THROW(static_cast<void>(patch_tolerance(extent, 0, 1, {})), Failure);
}

}  // namespace
}  // namespace talus::support
