// The pieces a stream is made of, each alone: heights as codes, covers, bits of a level, lengths, and two sets of vertices
// that become one. Each against a plain way to do the same.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "engine/quadtree/merge.hpp"
#include "engine/quadtree/scattered_vertices.hpp"
#include "engine/stream/bit_lattice.hpp"
#include "engine/stream/scattered_numbers.hpp"
#include "engine/stream/stream_bytes.hpp"
#include "engine/stream/stream_covers.hpp"
#include "engine/stream/stream_heights.hpp"
#include "talus/failure.hpp"
#include "tests/engine/random_answers.hpp"
#include "tests/support/quadtrees.hpp"

namespace talus::support {
namespace {

using Bytes = std::vector<std::byte>;

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

template <class Code>
void expect_back(const HeightCoding& coding, const std::vector<double>& heights) {
  const auto codes = codes_of<Code>(coding, heights);
  ASSERT_TRUE(codes);
  const Array<double> back = heights_of<Code>(coding, std::span<const Code>(codes->data(), codes->size()));
  ASSERT_EQ(back.size(), heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) EXPECT_TRUE(same_bits(back[i], heights[i])) << heights[i];
}

TEST(StreamHeights, ComeBackBitForBit) {
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Description d;
    d.minimum = -500, d.maximum = 4000;
    const int kind = static_cast<int>(seed % 4);  // whole numbers of a step, floats, doubles, quanta
    d.step = kind == 0 ? HeightStep{1, random.chance(0.5) ? 1.0 : 10.0, random.chance(0.5) ? 0.0 : -3.25, true}
                       : HeightStep{1, 1, 0, false};
    const Metres quantum{kind == 3 ? random.log_between(0.001, 10) : 0};
    std::vector<double> heights;
    for (int i = 0; i < 300; ++i) {
      const double h = random.within(-500, 4000);
      heights.push_back(kind == 0   ? d.step.value(std::nearbyint(h))
                        : kind == 1 ? static_cast<double>(static_cast<float>(h))
                        : kind == 2 ? h
                                    : (std::nearbyint(h / quantum.value) + 0.0) * (quantum.value / d.metres_per_unit));
    }
    if (kind == 1) heights.insert(heights.end(), {-0.0, 0.0, std::numeric_limits<float>::denorm_min()});
    const std::span<const double> all = heights;
    const HeightCoding coding = HeightCoding::of(d, quantum, Metres{1}, {&all, 1});
    if (coding.is_wide) {
      expect_back<std::int64_t>(coding, heights);
    } else {
      expect_back<std::int32_t>(coding, heights);
      expect_back<std::int64_t>(coding, heights);
    }
  }
}

TEST(StreamHeights, RefuseWhatIsNoNumber) {
  const std::vector<double> heights{1, std::numeric_limits<double>::quiet_NaN()};
  const std::span<const double> all = heights;
  EXPECT_THROW(static_cast<void>(HeightCoding::of(Description{}, Metres{0}, Metres{1}, {&all, 1})), Failure);
}

TEST(StreamCovers, ComeBackInAnyOrderThatBothSidesKnow) {
  int with_covers = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const RestrictedQuadtree answer = random_answer(random, random_rect(random, 40), 60);
    std::vector<GridPoint> points;
    answer.vertices.for_each([&](GridPoint p) { points.push_back(p); });
    std::stable_sort(points.begin(), points.end(), [](GridPoint a, GridPoint b) { return spacing(a) > spacing(b); });
    std::vector<std::uint8_t> covers(points.size(), 15);
    for (std::size_t i = 0; i < points.size() && !answer.covers.empty(); ++i)
      covers[i] = answer.covers[answer.vertices.rank(points[i])];
    with_covers += answer.covers.empty() ? 0 : 1;
    // In two pieces, as the parts of a stream come.
    const std::size_t half = points.size() / 2;
    CoverCoder writer, reader;
    for (const auto& [first, count] : {std::pair{std::size_t{0}, half}, {half, points.size() - half}}) {
      const auto some = std::span<const GridPoint>(points).subspan(first, count);
      const Bytes bytes = writer.encode(some, std::span<const std::uint8_t>(covers).subspan(first, count));
      const std::vector<std::uint8_t> back = reader.decode(bytes, some);
      ASSERT_TRUE(std::equal(back.begin(), back.end(), covers.begin() + static_cast<std::ptrdiff_t>(first)));
      for (std::size_t size = 1; size < bytes.size(); size += 1 + size / 8) {
        CoverCoder other;
        try {
          static_cast<void>(other.decode(std::span<const std::byte>(bytes).first(size), some));
        } catch (const Failure& failure) {
          EXPECT_EQ(failure.cause(), Cause::corrupt);
        }
      }
    }
  }
  EXPECT_GT(with_covers, 30);
}

TEST(BitLattice, HoldsTheMultiplesOfEachSpacing) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridRect window = random_rect(random, 200);
    VertexMask mask(window);
    for (int i = 0; i < 400; ++i) mask.insert(random_point(random, window));
    mask.seal();
    BitLattice bits = bits_of(mask);
    for (int shift = 0; shift < 7; ++shift) {
      ASSERT_EQ(bits.shift, shift);
      std::size_t members = 0, expected = 0;
      for (std::int32_t j = 0; j < bits.rows; ++j) {
        for (std::int32_t i = 0; i < bits.cols; ++i) {
          if (!bits.contains(i, j)) continue;
          ++members;
          ASSERT_TRUE(window.contains(bits.at(i, j)) && mask.contains(bits.at(i, j)));
        }
      }
      mask.for_each([&](GridPoint p) { expected += p.col % (1 << shift) == 0 && p.row % (1 << shift) == 0 ? 1 : 0; });
      EXPECT_EQ(members, expected);
      bits = coarser(bits, window);
    }
  }
}

TEST(BitLattice, SpreadBitsAreGatheredAgain) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t v = random.next() & 0xffffffffu, spread = spread_bits(v);
    for (int bit = 0; bit < 32; ++bit) ASSERT_EQ(spread >> (2 * bit) & 3u, v >> bit & 1u);
    EXPECT_EQ(gathered_bits(spread | (random.next() & 0xaaaaaaaaaaaaaaaau)), v);
  }
}

TEST(StreamBytes, LengthsComeBackAndTruncationsAreCorrupt) {
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const std::uint64_t value = random.next() >> random.between(1, 63);
    Bytes bytes;
    put_variable(bytes, value);
    EXPECT_EQ(VariableReader(bytes).value(), value);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      VariableReader cut(std::span<const std::byte>(bytes).first(size));
      EXPECT_THROW(static_cast<void>(cut.value()), Failure);
    }
  }
  const Bytes endless(20, std::byte{255});
  VariableReader in(endless);
  EXPECT_THROW(static_cast<void>(in.value()), Failure);
}

TEST(ScatteredVertices, AreVisitedOnceFinestLevelFirst) {
  Random random(5);
  for (int time = 0; time < 30; ++time) {
    ScatteredVertices vertices;
    std::set<std::pair<std::int32_t, std::int32_t>> expected;
    for (int i = 0; i < 300; ++i) {
      const GridPoint p = random_point(random, {{-50, -50}, {50, 50}});
      vertices.insert(p);
      expected.insert({p.col, p.row});
    }
    std::set<std::pair<std::int32_t, std::int32_t>> visited;
    int last = -1;
    vertices.for_each([&](GridPoint p) {
      EXPECT_TRUE(visited.insert({p.col, p.row}).second) << "twice";
      const int level = 2 * height_in_tree(p) + (is_centre(p) ? 1 : 0);
      EXPECT_GE(level, last);
      last = level;
    });
    EXPECT_EQ(visited, expected);
  }
}

TEST(ScatteredNumbers, PointsAndHeightsComeBackAndForeignPointsAreCorrupt) {
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridRect window = random_rect(random, 300);
    const BitLattice lattice(window, random.between(0, 4));
    Scattered<std::int32_t> vertices;
    for (std::int32_t j = 0; j < lattice.rows; ++j) {
      for (std::int32_t i = 0; i < lattice.cols; ++i) {
        if (!random.chance(0.05)) continue;
        vertices.points.push_back(lattice.at(i, j));
        vertices.heights.push_back(static_cast<std::int32_t>(random.next()));
      }
    }
    NumberWriter out;
    put_points(out, lattice, vertices.points);
    put_heights(out, vertices);
    Bytes bytes;
    out.finish(bytes);
    const auto read = [&](std::uint64_t most, bool accepts) {
      NumberReader in;
      in.start(bytes);
      Scattered<std::int32_t> back{take_points(in, lattice, most, [&](GridPoint) { return accepts; }), {}};
      take_heights(in, back);
      EXPECT_TRUE(in.is_intact());
      return back;
    };
    const Scattered<std::int32_t> back = read(vertices.points.size(), true);
    EXPECT_EQ(back.points, vertices.points);
    EXPECT_EQ(back.heights, vertices.heights);
    if (vertices.points.empty()) continue;
    EXPECT_THROW(static_cast<void>(read(vertices.points.size() - 1, true)), Failure) << "more than there may be";
    EXPECT_THROW(static_cast<void>(read(vertices.points.size(), false)), Failure) << "none may be there";
  }
}

TEST(United, IsBothSetsWithTheirHeightsAndCovers) {
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridRect window = random_rect(random, 60);
    RestrictedQuadtree kept, added;
    std::map<Point, std::pair<double, std::uint8_t>> expected;
    std::vector<GridPoint> gone;
    const bool covers = random.chance(0.5);
    for (RestrictedQuadtree* q : {&kept, &added}) q->region = window, q->vertices = VertexMask(window);
    for_each_point(window, [&](GridPoint p) {
      if (random.chance(0.6)) return;
      (random.chance(0.5) ? kept : added).vertices.insert(p);
    });
    for (RestrictedQuadtree* q : {&kept, &added}) {
      q->vertices.seal();
      q->vertices.for_each([&](GridPoint p) {
        q->heights.push_back(random.within(0, 100));
        if (covers) q->covers.push_back(static_cast<std::uint8_t>(random.between(0, 15)));
        const std::uint8_t cover = covers ? q->covers.back() : std::uint8_t{15};
        if (q == &kept && random.chance(0.2)) {
          gone.push_back(p);
        } else {
          expected[key(p)] = {q->heights[q->heights.size() - 1], cover};
        }
      });
    }
    const RestrictedQuadtree both = united(kept, gone, added);
    ASSERT_EQ(both.vertices.size(), expected.size());
    std::size_t i = 0;
    both.vertices.for_each([&](GridPoint p) {
      const auto found = expected.find(key(p));
      ASSERT_NE(found, expected.end());
      EXPECT_TRUE(same_bits(both.heights[i], found->second.first));
      EXPECT_EQ(both.covers.empty() ? 15 : both.covers[i], found->second.second);
      ++i;
    });
    EXPECT_EQ(both.region, added.region);
    if (kept.vertices.size() > 0) {
      EXPECT_THROW(static_cast<void>(united(kept, {}, kept)), Failure) << "one set, twice";
    }
  }
}

}  // namespace
}  // namespace talus::support
