// A few vertices of a stream, one number after the other: what was put is taken, and foreign points are corrupt.

#include "engine/stream/scattered_numbers.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/random_answers.hpp"

namespace talus::support {
namespace {

using Bytes = std::vector<std::byte>;

TEST(ScatteredNumbers, SignsAreFoldedIntoTheLowestBit) {
  using Limits = std::numeric_limits<std::int64_t>;
  EXPECT_EQ(folded(0), 0u);
  EXPECT_EQ(folded(-1), 1u);
  EXPECT_EQ(folded(1), 2u);
  EXPECT_EQ(folded(-2), 3u);
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto v = static_cast<std::int64_t>(random.next()) >> random.between(0, 63);
    EXPECT_EQ(unfolded(folded(v)), v);
  }
  for (const std::int64_t v : {Limits::min(), Limits::max()}) EXPECT_EQ(unfolded(folded(v)), v);
}

TEST(ScatteredNumbers, AHeightIsGuessedFromTheNearestVertexBefore) {
  Neighbourhood near;
  EXPECT_EQ(near.guess({5, 5}).height, 0) << "nothing came before";
  near.take({5, 5}, 100);
  EXPECT_EQ(near.guess({9, 5}).height, 100) << "of its row";
  near.take({9, 5}, 200);
  EXPECT_EQ(near.guess({5, 7}).height, 100) << "of its column";
  EXPECT_EQ(near.guess({9, 7}).height, 200);
  EXPECT_EQ(near.guess({6, 7}).height, 200) << "the last one, where neither has any";
  near.take({4, 7}, 300);
  EXPECT_EQ(near.guess({5, 7}).height, 300) << "one column away and not two rows";
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

TEST(ScatteredNumbers, TruncationsAndAnyBytesAreCorruptOrLeadToPointsInTheWindow) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridRect window = random_rect(random, 40);
    const BitLattice lattice(window, random.between(0, 2));
    if (lattice.cols == 0 || lattice.rows == 0) continue;
    Scattered<std::int64_t> vertices;
    for (std::int32_t j = 0; j < lattice.rows; ++j) {
      for (std::int32_t i = 0; i < lattice.cols; ++i) {
        if (!random.chance(0.2)) continue;
        vertices.points.push_back(lattice.at(i, j));
        vertices.heights.push_back(static_cast<std::int64_t>(random.next()));
      }
    }
    NumberWriter out;
    put_points(out, lattice, vertices.points);
    put_heights(out, vertices);
    Bytes bytes;
    out.finish(bytes);
    // Whether these bytes were read as sound.
    const auto read = [&](std::span<const std::byte> some) {
      NumberReader in;
      in.start(some);
      try {
        Scattered<std::int64_t> back{take_points(in, lattice, 5000, [&](GridPoint) { return true; }), {}};
        take_heights(in, back);
        EXPECT_EQ(back.heights.size(), back.points.size());
        for (const GridPoint p : back.points) EXPECT_TRUE(window.contains(p));
        return in.is_intact();
      } catch (const Failure& failure) {
        EXPECT_EQ(failure.cause(), Cause::corrupt);
        return false;
      }
    };
    EXPECT_TRUE(read(bytes));
    for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(read(std::span(bytes).first(size))) << size;
    for (int time = 0; time < 100; ++time) {
      Bytes other = bytes;
      for (int flips = random.between(1, 5); flips > 0; --flips)
        other[static_cast<std::size_t>(random.next() % other.size())] ^= static_cast<std::byte>(random.between(1, 255));
      static_cast<void>(read(other));
    }
  }
}

}  // namespace
}  // namespace talus::support
