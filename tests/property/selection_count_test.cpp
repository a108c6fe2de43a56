// How many vertices an answer has, against the exact nested set computed from its definition.
//
// e(P) is the largest vertical distance of any sample in the closed diamond of P to the two triangles that
// stand there while P is absent; ê(P) the largest e of P and its descendants. The answer at ε must hold
// every P with ê(P) > ε, and, but for what its border asks, hardly any other.

#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/real_models.hpp"

namespace talus::support {
namespace {

struct Point {
  int x = 0, y = 0;
};
Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
bool odd(int a) { return (a & 1) != 0; }
int lowest_bit(int a) { return a & -a; }

/// Where a vertex stands in the bisection: its diamond has the hypotenuse a–b and the apexes c and d, which
/// are also its parents.
struct Diamond {
  int spacing = 0;
  Point a, b, c, d;
};

Diamond diamond_of(Point p) {
  const int s = lowest_bit(p.x | p.y);
  if (!odd(p.x / s)) return {s, p + Point{0, -s}, p + Point{0, s}, p + Point{-s, 0}, p + Point{s, 0}};
  if (!odd(p.y / s)) return {s, p + Point{-s, 0}, p + Point{s, 0}, p + Point{0, -s}, p + Point{0, s}};
  // A centre. Its block is cut between the corners that are also corner and centre of the block around it:
  // those whose coordinates, counted in blocks, have an even sum.
  const Diamond falling{s, p + Point{-s, -s}, p + Point{s, s}, p + Point{s, -s}, p + Point{-s, s}};
  const Diamond rising{s, falling.c, falling.d, falling.a, falling.b};
  return odd((p.x - s) / (2 * s) + (p.y - s) / (2 * s)) ? rising : falling;
}

/// Saturated errors of a square terrain of 2^k cells, in metres, by the definition.
class NestedSet {
 public:
  explicit NestedSet(const Terrain& terrain)
      : terrain_(terrain), side_(terrain.cols - 1), errors_(terrain.values.size()) {
    for (int s = 1; s < side_; s *= 2) {
      // Edge midpoints are children of centres of the same spacing, and come first.
      each(s, [&](Point p) {
        if (odd(p.x / s) != odd(p.y / s)) settle(p);
      });
      each(s, [&](Point p) {
        if (odd(p.x / s) && odd(p.y / s)) settle(p);
      });
    }
  }

  [[nodiscard]] bool holds(Point p, double tolerance) const { return error(p) > tolerance; }
  [[nodiscard]] double error(Point p) const { return errors_[terrain_.index(p.x, p.y)]; }

 private:
  template <class Visit>
  void each(int s, Visit&& visit) const {
    for (int y = 0; y <= side_; y += s) {
      for (int x = 0; x <= side_; x += s) visit(Point{x, y});
    }
  }
  [[nodiscard]] bool inside(Point p) const { return p.x >= 0 && p.y >= 0 && p.x <= side_ && p.y <= side_; }

  void settle(Point p) {
    const Diamond diamond = diamond_of(p);
    double& mine = errors_[terrain_.index(p.x, p.y)];
    for (const Point apex : {diamond.c, diamond.d}) {
      if (inside(apex) && inside(diamond.a) && inside(diamond.b))
        mine = std::max(mine, half(diamond.a, diamond.b, apex));
    }
    for (const Point parent : {diamond.c, diamond.d}) {
      if (!inside(parent)) continue;
      double& above = errors_[terrain_.index(parent.x, parent.y)];
      above = std::max(above, mine);
    }
  }

  /// Over all samples of a closed triangle. Heights are integers and areas powers of two: exact in doubles.
  [[nodiscard]] double half(Point a, Point b, Point c) const {
    const auto cross = [](Point o, Point p, Point q) { return (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x); };
    if (cross(a, b, c) < 0) std::swap(a, b);
    const int area2 = cross(a, b, c);
    const double ha = terrain_.at(a.x, a.y), hb = terrain_.at(b.x, b.y), hc = terrain_.at(c.x, c.y);
    double largest = 0;
    for (int y = std::min({a.y, b.y, c.y}); y <= std::max({a.y, b.y, c.y}); ++y) {
      for (int x = std::min({a.x, b.x, c.x}); x <= std::max({a.x, b.x, c.x}); ++x) {
        const int wa = cross(b, c, {x, y}), wb = cross(c, a, {x, y}), wc = cross(a, b, {x, y});
        if (wa < 0 || wb < 0 || wc < 0) continue;
        largest = std::max(largest, std::abs(terrain_.at(x, y) - (wa * ha + wb * hb + wc * hc) / area2));
      }
    }
    return largest;
  }

  const Terrain& terrain_;
  int side_;
  std::vector<double> errors_;
};

/// What the border of a square of `side` cells forces: its sides are cut greedily into dyadic edges of at
/// most 16 cells, the younger end of each is a vertex, and all their ancestors are too.
class BorderSet {
 public:
  explicit BorderSet(int side)
      : side_(side), member_(static_cast<std::size_t>(3 * side + 1) * static_cast<std::size_t>(3 * side + 1)) {
    for (const int line : {0, side}) {
      for (int p = 0; p < side;) {
        int length = 16;
        while (line % length != 0 || p % length != 0 || p + length > side) length /= 2;
        for (const int end : {p, p + length}) {
          if (odd(end / length) == odd(line / length)) continue;  // exactly one is odd at the younger end
          add({end, line});
          add({line, end});
        }
        p += length;
      }
    }
    for (const Point corner : {Point{0, 0}, {side, 0}, {0, side}, {side, side}}) member_[place(corner)] = 1;
  }
  [[nodiscard]] bool holds(Point p) const { return member_[place(p)] != 0; }

 private:
  // Ancestors may lie beyond the square and have theirs inside it: one more square on every side is enough.
  [[nodiscard]] bool known(Point p) const { return std::min(p.x, p.y) >= -side_ && std::max(p.x, p.y) <= 2 * side_; }
  [[nodiscard]] std::size_t place(Point p) const {
    return static_cast<std::size_t>(p.y + side_) * static_cast<std::size_t>(3 * side_ + 1) +
           static_cast<std::size_t>(p.x + side_);
  }
  void add(Point p) {
    if (!known(p) || holds(p)) return;
    member_[place(p)] = 1;
    if (lowest_bit(p.x | p.y) == 0 || lowest_bit(p.x | p.y) >= side_) return;  // a corner of the square's grid
    const Diamond diamond = diamond_of(p);
    add(diamond.c);
    add(diamond.d);
  }
  int side_;
  std::vector<std::uint8_t> member_;
};

struct Crop {
  const char* model;
  int col, row, cells;
};

class Selection : public ::testing::TestWithParam<Crop> {};

TEST_P(Selection, IsTheExactNestedSet) {
  const auto [name, col, row, cells] = GetParam();
  const TempFolder folder;
  Terrain terrain;
  if (std::string(name) == "fractal") {
    terrain = fit(fractal(cells + 1, cells + 1, 20, 1500), SampleType::int16);
  } else {
    const RealModel model = real_model(name, folder);
    if (!model.file) GTEST_SKIP() << model.why_not;
    terrain = crop(read_raster(*model.file), col, row, cells + 1, cells + 1);
    if (terrain.has_voids())
      GTEST_SKIP() << "the crop has voids; its definition needs heights that only the ingest knows";
  }
  write_raster(terrain, folder / "crop.tif");
  ingest(folder / "crop.tif", folder / "crop.talus");
  const Snapshot now = Database::open(folder / "crop.talus").snapshot();

  const NestedSet nested(terrain);
  const BorderSet border(cells);
  for (const double tolerance : {0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 0.3, 1.7, 50.0}) {
    const Answer answer = now.ask({.region = now.description().extent, .tolerance = Metres{tolerance}});
    std::size_t wanted = 0, missing = 0, extra = 0;
    for (int y = 0; y <= cells; ++y) {
      for (int x = 0; x <= cells; ++x) {
        const bool answered = answer.quadtree.vertices.contains({x, y});
        const bool in_set = nested.holds({x, y}, tolerance);
        wanted += in_set ? 1 : 0;
        missing += in_set && !answered ? 1 : 0;
        extra += answered && !in_set && !border.holds({x, y}) ? 1 : 0;
      }
    }
    std::printf("%s %d cells at %g m: %zu in the nested set, %zu answered, %zu of them beyond it and the border\n",
                name, cells, tolerance, wanted, answer.quadtree.vertices.size(), extra);
    EXPECT_EQ(missing, 0u) << "at " << tolerance << " m";
    EXPECT_LE(static_cast<double>(extra), 0.01 * static_cast<double>(wanted)) << "at " << tolerance << " m";
    if (tolerance == 0) {
      EXPECT_EQ(extra, 0u) << "with no tolerance, only samples that are not exactly interpolated";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Selection,
                         ::testing::Values(Crop{"srtm3_S36E149.tif", 200, 300, 256},
                                           Crop{"srtm3_S36E149.tif", 600, 100, 512},
                                           Crop{"bigtujunga_30m_utm11.tif", 500, 200, 256},
                                           Crop{"bigtujunga_30m_utm11.tif", 340, 60, 512}, Crop{"fractal", 0, 0, 256},
                                           Crop{"fractal", 0, 0, 512}),
                         [](const auto& about) {
                           std::string name = std::string(about.param.model) + "_" + std::to_string(about.param.cells);
                           for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name;
                         });

}  // namespace
}  // namespace talus::support
