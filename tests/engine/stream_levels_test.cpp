// The parts of a stream without its header and checksums: what was written is read, and what is damaged is refused.

#include "engine/stream/stream_levels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/engine/random_answers.hpp"
#include "tests/support/quadtrees.hpp"

namespace talus::support {
namespace {

TEST(KnownLevels, HoldEachVertexByLevelAndHalfRowByRow) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int root = random.between(1, 6);
    KnownLevels<std::int32_t> known(root);
    std::map<std::array<int, 4>, std::int32_t> expected;  // level, half, row, column
    for (int i = 0; i < 200; ++i) {
      const GridPoint p = random_point(random, {{-70, -70}, {70, 70}});
      const int level = std::min(height_in_tree(p), root);
      const auto height = static_cast<std::int32_t>(random.next());
      if (!expected.try_emplace({level, level < root && is_centre(p) ? 0 : 1, p.row, p.col}, height).second) continue;
      known.insert(p, height);
    }
    known.sort();
    std::map<std::array<int, 4>, std::int32_t> found;
    for (int level = 0; level <= root; ++level) {
      std::size_t size = 0;
      for (const int half : {0, 1}) {
        const auto& all = known.at(level, static_cast<std::size_t>(half));
        std::vector<std::pair<int, int>> places;
        for (std::size_t i = 0; i < all.points.size(); ++i) {
          const GridPoint p = all.points[i];
          found[{level, half, p.row, p.col}] = all.heights[i];
          places.emplace_back(p.row, p.col);
        }
        EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
        size += all.points.size();
      }
      EXPECT_EQ(known.size(level), size);
    }
    EXPECT_EQ(found, expected);
  }
}

/// An answer, or what an increment adds to a base, with all that its parts need.
template <class Code>
struct Sent {
  StreamHeader header;
  RestrictedQuadtree content;
  std::optional<RestrictedQuadtree> base;
  std::vector<Code> codes, base_codes;

  [[nodiscard]] const RestrictedQuadtree* below() const { return base ? &*base : nullptr; }
  [[nodiscard]] std::vector<EncodedPart> parts(int stripes = 0) const {
    StreamOptions options;
    options.stripes = stripes;
    options.threads = 1;
    return encode_parts<Code>(header, content, codes, below(), base_codes, options);
  }
};

RestrictedQuadtree part_of(const RestrictedQuadtree& all, const VertexMask& wanted) {
  RestrictedQuadtree q;
  q.region = all.region;
  q.vertices = wanted;
  q.vertices.seal();
  q.vertices.for_each([&](GridPoint p) {
    q.heights.push_back(all.heights[all.vertices.rank(p)]);
    if (!all.covers.empty()) q.covers.push_back(all.covers[all.vertices.rank(p)]);
  });
  return q;
}

template <class Code>
Sent<Code> random_sent(Random& random, int side = 50) {
  Sent<Code> sent;
  const GridRect window = random_rect(random, side);
  RestrictedQuadtree all = random_answer(random, window, 150);
  if (all.region.cols() <= 0) all.region = window;
  for (double& h : all.heights) h = random.between(-900, 900);
  sent.content = all;
  if (random.chance(0.4)) {  // an increment: the base has the coarser vertices and some others
    VertexMask first(window), rest(window);
    const std::int32_t from = 1 << random.between(0, 4);
    all.vertices.for_each([&](GridPoint p) { (spacing(p) >= from || random.chance(0.2) ? first : rest).insert(p); });
    sent.base = part_of(all, first);
    sent.content = part_of(all, rest);
  }
  StreamHeader& h = sent.header;
  h.quadtree.region = all.region;
  h.quadtree.tolerance = Metres{std::ldexp(1, random.between(0, 6))};
  h.quadtree.bound = h.quadtree.tolerance;
  h.window = window;
  h.is_increment = sent.base.has_value();
  h.has_covers = !sent.content.covers.empty();
  h.has_loose = h.has_covers || h.is_increment || random.chance(0.3);
  h.is_wide = sizeof(Code) == 8;
  h.vertices = sent.content.vertices.size();
  h.parts = 1 + static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(root_side(window))));
  for (const double v : sent.content.heights) sent.codes.push_back(static_cast<Code>(v));
  if (sent.base) {
    for (const double v : sent.base->heights) sent.base_codes.push_back(static_cast<Code>(v));
  }
  return sent;
}

/// What is read of these parts; nothing, if they were refused.
template <class Code>
std::optional<RestrictedQuadtree> read(const Sent<Code>& sent, const std::vector<EncodedPart>& parts) {
  try {
    PartsDecoder<Code> decoder(sent.header, sent.below(), sent.base_codes, 1);
    for (const EncodedPart& part : parts) decoder.take(part.payload, part.vertices);
    RestrictedQuadtree q = decoder.quadtree();
    EXPECT_LE(q.vertices.size(), sent.header.vertices);
    EXPECT_EQ(q.heights.size(), q.vertices.size());
    return q;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::corrupt) << failure.what();
    return std::nullopt;
  }
}

template <class Code>
void expect_back() {
  int increments = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Sent<Code> sent = random_sent<Code>(random);
    increments += sent.base ? 1 : 0;
    for (const int stripes : {0, 3}) {
      const std::vector<EncodedPart> parts = sent.parts(stripes);
      ASSERT_EQ(parts.size(), sent.header.parts);
      const auto back = read(sent, parts);
      ASSERT_TRUE(back);
      RestrictedQuadtree expected = sent.content;
      expected.region = sent.header.quadtree.region;
      expected.tolerance = sent.header.quadtree.tolerance;
      expected.bound = sent.header.quadtree.bound;
      EXPECT_EQ(difference(*back, expected), "");
    }
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(increments, 20);
}

TEST(StreamLevels, PartsComeBackWithEveryVertexHeightAndCover) { expect_back<std::int32_t>(); }
TEST(StreamLevels, WidePartsComeBackWithEveryVertexHeightAndCover) { expect_back<std::int64_t>(); }

TEST(StreamLevels, TheFirstPartsAreTheCoarserLevels) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto sent = random_sent<std::int32_t>(random);
    const std::vector<EncodedPart> parts = sent.parts();
    PartsDecoder<std::int32_t> decoder(sent.header, sent.below(), sent.base_codes, 1);
    std::uint64_t vertices = 0;
    for (std::size_t part = 0; part < parts.size(); ++part) {
      decoder.take(parts[part].payload, parts[part].vertices);
      vertices += parts[part].vertices;
      EXPECT_EQ(decoder.vertices(), vertices);
      const RestrictedQuadtree so_far = decoder.quadtree();
      ASSERT_EQ(so_far.vertices.size(), vertices);
      sent.content.vertices.for_each([&](GridPoint p) {
        const bool is_coarse = height_in_tree(p) >= sent.header.root() - static_cast<int>(part);
        if (is_coarse) {
          EXPECT_TRUE(so_far.vertices.contains(p)) << name_of(p) << " after part " << part;
        }
      });
      so_far.vertices.for_each([&](GridPoint p) {
        ASSERT_TRUE(sent.content.vertices.contains(p));
        EXPECT_EQ(so_far.heights[so_far.vertices.rank(p)], sent.content.heights[sent.content.vertices.rank(p)]);
      });
    }
    EXPECT_EQ(vertices, sent.content.vertices.size());
  }
}

TEST(StreamLevels, EveryTruncationAndEveryOtherCountIsRefused) {
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto sent = random_sent<std::int32_t>(random, 24);
    const std::vector<EncodedPart> parts = sent.parts();
    for (std::size_t part = 0; part < parts.size(); ++part) {
      SCOPED_TRACE("part " + std::to_string(part));
      for (std::size_t size = 0; size < parts[part].payload.size(); ++size) {
        std::vector<EncodedPart> cut = parts;
        cut[part].payload.resize(size);
        EXPECT_FALSE(read(sent, cut)) << size << " of " << parts[part].payload.size() << " bytes";
      }
      std::vector<EncodedPart> other = parts;
      other[part].payload.push_back(std::byte{0});
      EXPECT_FALSE(read(sent, other)) << "a byte too many";
      other = parts;
      ++other[part].vertices;
      EXPECT_FALSE(read(sent, other)) << "a vertex more than there is";
      if (parts[part].vertices == 0) continue;
      other = parts;
      --other[part].vertices;
      EXPECT_FALSE(read(sent, other)) << "a vertex less than there is";
    }
  }
}

TEST(StreamLevels, AnyBytesAreRefusedOrHarmless) {
  int refused = 0, harmless = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto sent = random_sent<std::int32_t>(random, 30);
    const std::vector<EncodedPart> parts = sent.parts();
    for (int time = 0; time < 60; ++time) {
      std::vector<EncodedPart> other = parts;
      EncodedPart& part = other[static_cast<std::size_t>(random.next() % other.size())];
      for (int flips = random.between(1, 3); flips > 0 && !part.payload.empty(); --flips)
        part.payload[static_cast<std::size_t>(random.next() % part.payload.size())] ^=
            static_cast<std::byte>(random.between(1, 255));
      if (time % 10 == 0) {
        for (std::byte& byte : part.payload) byte = static_cast<std::byte>(random.next());
      }
      if (time % 10 == 1) std::swap(other.front(), other.back());
      ++(read(sent, other) ? harmless : refused);
    }
  }
  EXPECT_GT(refused, 1500);
  EXPECT_GT(harmless, 10) << "heights may be others: checksums stand around the parts";
  EXPECT_LT(harmless, 120) << "a level that is not read to its end is damaged";
}

}  // namespace
}  // namespace talus::support
