// Which triangles of vertices hold data: what was written is read, and what is damaged is refused.

#include "engine/stream/stream_covers.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/page/number_coder.hpp"
#include "talus/failure.hpp"
#include "tests/engine/random_answers.hpp"

namespace talus::support {
namespace {

using Bytes = std::vector<std::byte>;

/// The vertices of an answer with covers, coarsest first, as a stream has them.
struct Covered {
  RestrictedQuadtree answer;
  std::vector<GridPoint> points;
  std::vector<std::uint8_t> covers;
};
Covered covered(std::uint64_t seed) {
  for (;; seed += 1000) {
    Random random(seed);
    Covered c{random_answer(random, random_rect(random, 40), 60), {}, {}};
    if (c.answer.covers.empty()) continue;
    c.answer.vertices.for_each([&](GridPoint p) { c.points.push_back(p); });
    std::stable_sort(c.points.begin(), c.points.end(),
                     [](GridPoint a, GridPoint b) { return spacing(a) > spacing(b); });
    for (const GridPoint p : c.points) c.covers.push_back(c.answer.covers[c.answer.vertices.rank(p)]);
    const bool all_hold_data =
        std::all_of(c.covers.begin(), c.covers.end(), [](std::uint8_t cover) { return cover == 15; });
    if (!all_hold_data) return c;
  }
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

TEST(StreamCovers, TakeNoBytesWhereAllTrianglesHoldData) {
  const std::vector<GridPoint> points{{4, 4}, {2, 2}, {1, 1}};
  EXPECT_TRUE(CoverCoder().encode(points, std::vector<std::uint8_t>{15, 15, 15}).empty());
  EXPECT_FALSE(CoverCoder().encode(points, std::vector<std::uint8_t>{15, 15, 7}).empty());
  EXPECT_EQ(CoverCoder().decode({}, points), (std::vector<std::uint8_t>{15, 15, 15}));
}

TEST(StreamCovers, OfAnIncrementGoOnFromThoseOfItsBase) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const Covered c = covered(seed);
    const std::size_t half = c.points.size() / 2;
    const auto points = std::span(c.points);
    const auto covers = std::span(c.covers);
    CoverCoder in_one_go;
    static_cast<void>(in_one_go.encode(points.first(half), covers.first(half)));
    const Bytes expected = in_one_go.encode(points.subspan(half), covers.subspan(half));
    RestrictedQuadtree base;
    base.vertices = VertexMask(c.answer.vertices.region());
    for (const GridPoint p : points.first(half)) base.vertices.insert(p);
    base.vertices.seal();
    base.vertices.for_each([&](GridPoint p) { base.covers.push_back(c.answer.covers[c.answer.vertices.rank(p)]); });
    CoverCoder writer, reader;
    writer.take(base);
    reader.take(base);
    EXPECT_EQ(writer.encode(points.subspan(half), covers.subspan(half)), expected);
    const auto back = reader.decode(expected, points.subspan(half));
    EXPECT_TRUE(std::equal(back.begin(), back.end(), c.covers.begin() + static_cast<std::ptrdiff_t>(half)));
  }
}

TEST(StreamCovers, AVertexLikeItsParentsTakesFewerBits) {
  // One triangle of the centre holds no data. Below it neither half does, elsewhere all do.
  std::vector<GridPoint> points{{32, 32}};
  std::vector<std::uint8_t> alike{14}, unlike{14};
  const Diamond d = diamond({32, 32});
  for (int i = 0; i < 400; ++i) {  // side midpoints around the centre, over and over
    const GridPoint side = i % 4 == 0   ? midpoint(d.apexes[0], d.ends[0])
                           : i % 4 == 1 ? midpoint(d.apexes[0], d.ends[1])
                           : i % 4 == 2 ? midpoint(d.apexes[1], d.ends[0])
                                        : midpoint(d.apexes[1], d.ends[1]);
    points.push_back(side);
    const bool first = diamond(side).apexes[0] == points[0];
    const std::uint8_t without = i % 4 == 0 ? (first ? 12 : 3) : 15;  // its halves toward the centre
    alike.push_back(without);
    unlike.push_back(static_cast<std::uint8_t>(i % 4 == 1 ? (first ? 12 : 3) : 15));
  }
  EXPECT_EQ(CoverCoder().decode(CoverCoder().encode(points, alike), points), alike);
  EXPECT_EQ(CoverCoder().decode(CoverCoder().encode(points, unlike), points), unlike);
  EXPECT_LT(CoverCoder().encode(points, alike).size() + 20, CoverCoder().encode(points, unlike).size());
}

/// Whether these bytes were read; otherwise they were refused as corrupt.
bool is_read(std::span<const std::byte> bytes, std::span<const GridPoint> points) {
  try {
    const std::vector<std::uint8_t> covers = CoverCoder().decode(bytes, points);
    EXPECT_EQ(covers.size(), points.size());
    EXPECT_TRUE(std::all_of(covers.begin(), covers.end(), [](std::uint8_t c) { return c < 16; }));
    return true;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::corrupt);
    return false;
  }
}

TEST(StreamCovers, EveryTruncationIsRefusedAndAnyBytesAreRefusedOrHarmless) {
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const Covered c = covered(seed);
    const Bytes bytes = CoverCoder().encode(c.points, c.covers);
    EXPECT_TRUE(is_read(bytes, c.points));
    for (std::size_t size = 1; size < bytes.size(); ++size)  // no bytes at all say that all triangles hold data
      EXPECT_FALSE(is_read(std::span(bytes).first(size), c.points)) << size << " of " << bytes.size();
    EXPECT_FALSE(is_read(bytes, std::span(c.points).first(c.points.size() / 2))) << "more than the points need";
    Random random(seed);
    for (int time = 0; time < 100; ++time) {
      Bytes other = bytes;
      for (int flips = random.between(1, 4); flips > 0; --flips)
        other[static_cast<std::size_t>(random.next() % other.size())] ^= static_cast<std::byte>(random.between(1, 255));
      refused += is_read(other, c.points) ? 0 : 1;
      Bytes any(static_cast<std::size_t>(random.between(1, 60)));
      for (std::byte& byte : any) byte = static_cast<std::byte>(random.next());
      refused += is_read(any, c.points) ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 2000);
}

TEST(StreamCovers, NumbersThatStandForNoCoverAreRefused) {
  const auto is_number_read = [](GridPoint p, std::uint64_t number, int context) {
    NumberWriter out;
    out.put(number, context);
    if (context == 24) out.put(0, 24);  // its other side
    Bytes bytes;
    out.finish(bytes);
    return is_read(bytes, std::vector{p});
  };
  EXPECT_TRUE(is_number_read({0, 0}, 15, 40)) << "a root corner's four triangles are one number";
  EXPECT_FALSE(is_number_read({0, 0}, 16, 40));
  EXPECT_TRUE(is_number_read({1, 1}, 0, 24)) << "two triangles on each side";
  EXPECT_FALSE(is_number_read({1, 1}, 4, 24));
}

}  // namespace
}  // namespace talus::support
