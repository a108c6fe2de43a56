// Points and lines in CRS coordinates as samples, by answers that are known by thought and by a plain walk.

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "talus/question.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

using Samples = std::vector<GridPoint>;
constexpr GridRect kRegion{{2, 3}, {12, 13}};

Samples nearest(const std::vector<Position>& points, const Description& d = {}) {
  return samples_nearest(d, kRegion, points);
}
Samples along(const std::vector<Position>& line, const Description& d = {}) { return samples_along(d, kRegion, line); }

template <class Work>
std::string refusal(Work&& work) {
  try {
    static_cast<void>(work());
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::invalid_argument);
    return failure.what();
  }
  return "";
}

TEST(PointsAndLines, APointIsTheNearestSampleAlsoHalfACellBesideTheRegion) {
  EXPECT_EQ(nearest({{4.4, -7.4}, {4.6, -7.6}}), (Samples{{4, 7}, {5, 8}}));
  EXPECT_EQ(nearest({{4.5, -7.5}}), (Samples{{5, 8}})) << "amid samples: east and south";
  EXPECT_EQ(nearest({{1.6, -3}, {12.4, -13.4}}), (Samples{{2, 3}, {12, 13}}));
  EXPECT_EQ(nearest({{4, -7}, {4, -7}}).size(), 2u) << "one for each point";
  Description d;
  d.mapping = {1000, 2000, 10, -20};
  EXPECT_EQ(nearest({{1074, 1871}}, d), (Samples{{7, 6}}));
}

TEST(PointsAndLines, WhatIsNoPlaceInTheRegionIsRefused) {
  for (const Position p : {Position{1.4, -5}, {12.6, -5}, {5, -2.4}, {5, -13.6}}) {
    EXPECT_THAT(refusal([&] { return nearest({p}); }), ::testing::HasSubstr("in the region, x 2 to 12, y -13 to -3"));
    EXPECT_NE(refusal([&] { return along({{5, -5}, p}); }), "");
  }
  for (const double v : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(refusal([&] { return nearest({{v, -5}}); }), ::testing::HasSubstr("finite"));
    EXPECT_THAT(refusal([&] { return nearest({{5, v}}); }), ::testing::HasSubstr("finite"));
  }
  EXPECT_THAT(refusal([&] { return along({{5, -5}}); }), ::testing::HasSubstr("two or more"));
  EXPECT_THAT(refusal([&] { return along({}); }), ::testing::HasSubstr("two or more"));
}

TEST(PointsAndLines, ALineHasOneSampleAStepOfItsLongerAxis) {
  EXPECT_EQ(along({{3, -4}, {6, -4}}), (Samples{{3, 4}, {4, 4}, {5, 4}, {6, 4}}));
  EXPECT_EQ(along({{6, -4}, {3, -4}}), (Samples{{6, 4}, {5, 4}, {4, 4}, {3, 4}})) << "in the order of the line";
  EXPECT_EQ(along({{3, -4}, {3, -6}}), (Samples{{3, 4}, {3, 5}, {3, 6}}));
  EXPECT_EQ(along({{3, -4}, {5, -6}}), (Samples{{3, 4}, {4, 5}, {5, 6}}));
  EXPECT_EQ(along({{3, -4}, {7, -6}}), (Samples{{3, 4}, {4, 5}, {5, 5}, {6, 6}, {7, 6}})) << "halves go south";
  EXPECT_EQ(along({{4, -5}, {4, -5}}), (Samples{{4, 5}}));
  EXPECT_EQ(along({{3.3, -4}, {3.4, -4}}), (Samples{{3, 4}})) << "shorter than a cell";
  EXPECT_EQ(along({{3.6, -4}, {5.4, -4}}), (Samples{{4, 4}, {5, 4}}));
}

TEST(PointsAndLines, SamplesComeOnceInTheOrderInWhichTheyWereFirstMet) {
  EXPECT_EQ(along({{3, -4}, {5, -4}, {3, -4}, {3, -5}}), (Samples{{3, 4}, {4, 4}, {5, 4}, {3, 5}}));
  const std::vector<std::vector<Position>> lines{{{3, -4}, {5, -4}}, {{6, -5}, {4, -3}, {3, -3}}};
  EXPECT_EQ(samples_along(Description{}, kRegion, lines), (Samples{{3, 4}, {4, 4}, {5, 4}, {6, 5}, {4, 3}, {3, 3}}));
}

/// The sample nearest to each crossing of a line with a line of samples across its longer axis, and to its corners. By
/// trying all lines of samples up to 400.
std::set<std::pair<int, int>> stepped(const std::vector<Position>& line) {
  std::set<std::pair<int, int>> found;
  const auto add = [&](double col, double row) { found.emplace(std::floor(col + 0.5), std::floor(row + 0.5)); };
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double col = line[i - 1].x, row = -line[i - 1].y, cols = line[i].x - col, rows = -line[i].y - row;
    for (int at = 0; at <= 400; ++at) {
      const double t = std::abs(cols) >= std::abs(rows) ? (at - col) / cols : (at - row) / rows;
      if (t >= 0 && t <= 1) add(col + t * cols, row + t * rows);
    }
    add(col, row);
    add(col + cols, row + rows);
  }
  return found;
}

TEST(PointsAndLines, ManySamplesAreThoseOfFewOnesPutTogether) {
  // So many that a bit for each of the region's samples takes over from a list; and lines that cross often.
  const GridRect region{{0, 0}, {400, 300}};
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    std::vector<Position> line;
    const int corners = seed % 2 == 0 ? 60 : 4;
    for (int i = 0; i < corners; ++i) line.push_back({random.within(0, 400), -random.within(0, 300)});
    const Samples samples = samples_along(Description{}, region, line);
    std::set<std::pair<int, int>> found;
    for (const GridPoint p : samples) {
      EXPECT_TRUE(region.contains(p));
      EXPECT_TRUE(found.emplace(p.col, p.row).second) << "twice";
    }
    EXPECT_EQ(found, stepped(line));
    EXPECT_EQ(samples.size() > 4096, corners == 60);
    EXPECT_EQ(samples.front(), (GridPoint{static_cast<std::int32_t>(std::floor(line[0].x + 0.5)),
                                          static_cast<std::int32_t>(std::floor(-line[0].y + 0.5))}));
    // The order is that of the parts, each new one behind those before.
    Samples one_by_one;
    std::set<std::pair<int, int>> seen;
    for (std::size_t i = 1; i < line.size(); ++i) {
      for (const GridPoint p : samples_along(Description{}, region, std::vector<Position>{line[i - 1], line[i]})) {
        if (seen.emplace(p.col, p.row).second) one_by_one.push_back(p);
      }
    }
    EXPECT_EQ(samples, one_by_one);
  }
}

TEST(PointsAndLines, AroundTheGlobeALineGoesTheShortWayOnTheRowsBetween) {
  Description d;
  d.crs = {"WGS 84", 4326, true, 1, 1, 6378137, 1 / 298.257223563};
  d.mapping = {-180, 90, 10, -10};  // columns 0 to 35
  const GridRect globe{{0, 0}, {35, 18}};
  d.extent = globe;
  const std::vector<Position> eastward{{160, 50}, {-170, 20}}, westward{{-170, 20}, {160, 50}};
  EXPECT_EQ(samples_along(d, globe, eastward), (Samples{{34, 4}, {35, 5}, {0, 6}, {1, 7}}));
  EXPECT_EQ(samples_along(d, globe, westward), (Samples{{1, 7}, {0, 6}, {35, 5}, {34, 4}}));
  const std::vector<Position> long_way{{-160, 50}, {10, 50}};
  EXPECT_EQ(samples_along(d, globe, long_way).size(), 18u) << "less than half a turn: straight";
}

}  // namespace
}  // namespace talus::support
