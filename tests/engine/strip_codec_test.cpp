// Strips as bits: what is read is what was written, whoever reads it; what is damaged is refused.

#include "engine/strip/strip_codec.hpp"

#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/engine/random_answers.hpp"

namespace talus::support {
namespace {

/// By point; a point's height must be the same wherever it occurs.
std::map<Point, double> heights_of(const Mesh& mesh) {
  std::map<Point, double> heights;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const auto [at, added] = heights.emplace(key(mesh.points[i]), mesh.heights[i]);
    EXPECT_EQ(at->second, mesh.heights[i]);
  }
  return heights;
}

TEST(StripCodec, DecodesWhatWasEncoded) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const std::int32_t side = random.chance(0.1) ? 1500 : 100;  // now and then more than one patch
    const TriangleStrip strip = strip_of(random_answer(random, random_rect(random, side), random.between(0, 400)));
    const auto bytes = encode_strip(strip);
    const Mesh mesh = mesh_of(strip), read = decode_strip(bytes);
    EXPECT_EQ(read.region, mesh.region);
    EXPECT_EQ(turned_triangles(read), turned_triangles(mesh));
    EXPECT_EQ(heights_of(read), heights_of(mesh)) << "whole metres in steps of a metre";
    ASSERT_EQ(read.triangles.size(), mesh.triangles.size());
    for (std::size_t t = 0; t < read.triangles.size(); ++t) {  // in the strip's order, from the same corner on
      for (std::size_t i = 0; i < 3; ++i)
        ASSERT_EQ(read.points[read.triangles[t][i]], mesh.points[mesh.triangles[t][i]]);
    }
    const StripSizes sizes = strip_sizes(bytes);
    EXPECT_EQ(sizes.triangles, strip.triangles());
    EXPECT_EQ(sizes.runs, strip.runs.size()) << "jumps that the strip does not have";
    EXPECT_EQ(sizes.bytes, bytes.size());
    if (HasFailure()) return;
  }
}

TEST(StripCodec, HeightsMoveByHalfAStepAtMost) {
  Random random(5);
  RestrictedQuadtree answer = random_answer(random, {{-50, 20}, {63, 99}}, 300);
  for (double& h : answer.heights) h = -1000 + 3000 * random.unit();
  const TriangleStrip strip = strip_of(answer);
  const auto exact = heights_of(mesh_of(strip));
  for (const double step : {0.001, 0.5, 7.0, 5000.0}) {
    const auto bytes = encode_strip(strip, {step});
    for (const auto& [p, h] : heights_of(decode_strip(bytes)))
      EXPECT_LE(std::abs(h - exact.at(p)), step / 2 * (1 + 1e-9));
    EXPECT_LE(strip_sizes(bytes).height_bits, std::max(0.0, std::ceil(std::log2(3000 / step + 1))));
  }
}

TEST(StripCodec, ThreadsChangeNothing) {
  Random random(8);
  RestrictedQuadtree answer;  // more than a piece of work for one thread
  answer.vertices = VertexMask({{-37, -500}, {500, 37}});
  for_each_point(answer.vertices.region(), [&](GridPoint p) {
    answer.vertices.insert(p);
    answer.heights.push_back(random_height(p));
    answer.covers.push_back(random.chance(0.01) ? 7 : 15);
  });
  answer.vertices.seal();
  const auto bytes = encode_strip(strip_of(answer));
  const Mesh one = decode_strip(bytes, 1);
  for (const int threads : {2, 3, 8}) {
    const Mesh mesh = decode_strip(bytes, threads);
    EXPECT_TRUE(mesh.points == one.points && mesh.heights == one.heights && mesh.triangles == one.triangles) << threads;
  }
}

// The follow sets, spelt out as the paper's appendix does, against strips of quadtrees at random.
TEST(StripCodec, EveryStepIsInTheFollowSetOfTheOneBefore) {
  using enum StripType;
  constexpr bool L = false, R = true;
  const std::set<std::uint8_t> left_set{StripStep(a, L).bits, StripStep(b, R).bits, StripStep(c, L).bits};
  const std::set<std::uint8_t> right_set{StripStep(a, R).bits, StripStep(b, L).bits, StripStep(c, R).bits};
  const std::map<std::uint8_t, const std::set<std::uint8_t>*> follow{
      {StripStep(a, L).bits, &left_set},  {StripStep(b, L).bits, &left_set},  {StripStep(c, R).bits, &left_set},
      {StripStep(a, R).bits, &right_set}, {StripStep(b, R).bits, &right_set}, {StripStep(c, L).bits, &right_set}};
  std::set<std::pair<int, int>> seen;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const TriangleStrip strip = strip_of(random_answer(random, random_rect(random), random.between(0, 300)));
    std::size_t run = 0;
    for (std::size_t t = 0; t < strip.triangles(); ++t) {
      if (run < strip.runs.size() && strip.runs[run].first == t) {
        ++run;
        continue;
      }
      const StripStep before = strip.steps[t - 1], step = strip.steps[t];
      ASSERT_TRUE(follow.at(before.bits)->contains(step.bits)) << int{before.bits} << " then " << int{step.bits};
      ASSERT_EQ(turn_behind(before, step.type()), step.turns_right());
      seen.emplace(before.bits, step.bits);
    }
  }
  EXPECT_EQ(seen.size(), 18u) << "all that may follow does, somewhere";
}

TEST(StripCodec, SubStripHeadersAreWhatTheyPack) {
  Random random(3);
  for (int i = 0; i < 10000; ++i) {
    const auto bits = static_cast<std::uint32_t>(random.between(0, 0x7fffffff)) * 2u + (random.chance(0.5) ? 1u : 0u);
    EXPECT_EQ(SubStripHeader::unpack(bits).pack(), bits);
  }
}

Cause cause_of(std::span<const std::byte> bytes) {
  try {
    static_cast<void>(decode_strip(bytes));
  } catch (const Failure& failure) {
    return failure.cause();
  }
  return Cause{};
}

/// Small, but of several sub-strips, runs and patches.
std::vector<std::byte> small_strip() {
  for (std::uint64_t seed = 1;; ++seed) {
    Random random(seed);
    auto bytes = encode_strip(strip_of(random_answer(random, {{-9, 500}, {20, 518}}, 40)));
    const StripSizes sizes = strip_sizes(bytes);
    if (sizes.triangles > 64 && sizes.triangles < 256 && sizes.runs > 2 && sizes.patches > 2) return bytes;
  }
}

TEST(StripCodec, EveryTruncationIsCorrupt) {
  const auto bytes = small_strip();
  ASSERT_EQ(cause_of(bytes), Cause{});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ASSERT_EQ(cause_of(std::span(bytes).first(size)), Cause::corrupt) << size;
  }
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_EQ(cause_of(longer), Cause::corrupt);
}

TEST(StripCodec, EveryFlippedBitIsRefused) {
  auto bytes = small_strip();
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
    const bool of_the_version = bit / 8 >= 8 && bit / 8 < 12;
    ASSERT_EQ(cause_of(bytes), of_the_version ? Cause::unsupported : Cause::corrupt) << "bit " << bit;
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
  }
}

TEST(StripCodec, MoreTrianglesThanWantedAreRefused) {
  const auto bytes = small_strip();
  EXPECT_NO_THROW(static_cast<void>(decode_strip(bytes, 1, strip_sizes(bytes).triangles)));
  try {
    static_cast<void>(decode_strip(bytes, 1, strip_sizes(bytes).triangles - 1));
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::unsupported);
  }
}

TEST(StripCodec, WhatCannotBeCodedIsRefused) {
  Random random(4);
  const TriangleStrip good = strip_of(random_answer(random, {{0, 0}, {30, 30}}, 50));
  const auto refused = [&](auto&& spoil, double step = 1) {
    TriangleStrip bad = good;
    spoil(bad);
    try {
      static_cast<void>(encode_strip(bad, {step}));
    } catch (const Failure& failure) {
      return failure.cause() == Cause::invalid_argument;
    }
    return false;
  };
  const auto nothing = [](TriangleStrip&) {};
  EXPECT_TRUE(refused(nothing, 0));
  EXPECT_TRUE(refused(nothing, -1));
  EXPECT_TRUE(refused(nothing, NAN));
  EXPECT_TRUE(refused(nothing, 1e-9)) << "more than 32 bits";
  EXPECT_TRUE(refused([](TriangleStrip& s) { s.heights[1] = NAN; }));
  EXPECT_TRUE(refused([](TriangleStrip& s) { s.heights[1] = INFINITY; }));
  EXPECT_TRUE(refused([](TriangleStrip& s) { s.corners[1] = 1u << 30; }));
  EXPECT_TRUE(refused([](TriangleStrip& s) { s.steps.pop_back(); }));
  EXPECT_TRUE(refused([](TriangleStrip& s) { s.runs[0].first = 1; }));
  EXPECT_TRUE(refused([](TriangleStrip& s) { s.runs[0].left = s.runs[0].right; }));
  EXPECT_TRUE(refused([](TriangleStrip& s) { s.points[s.corners[1]].col += 1; }));
}

TEST(StripCodec, AnEmptyStripHasNoTriangles) {
  const auto bytes = encode_strip(TriangleStrip{});
  EXPECT_TRUE(decode_strip(bytes).triangles.empty());
}

}  // namespace
}  // namespace talus::support
