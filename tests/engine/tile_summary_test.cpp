// The record of a tile: what was written is read, and no bytes are taken that no record has.

#include "engine/tile/tile_summary.hpp"

#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

TileSummary random_summary(Random& random) {
  TileSummary s;
  for (std::size_t i = 0; i < TileSummary::kPosts; ++i) {
    s.post_valid[i] = random.chance(0.8) ? 1 : 0;
    s.posts[i] = s.post_valid[i] != 0 ? std::nearbyint(random.within(-400, 9000)) : 0;
  }
  s.valid_samples = random.next() % (std::uint64_t{1} << 20);
  s.lowest = random.within(-400, 0);
  s.highest = random.within(0, 9000);
  for (std::uint64_t& count : s.errors) count = random.next() % 100000;
  return s;
}

TEST(TileSummary, DecodeOfEncodeIsTheSummary) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const TileSummary s = random_summary(random), back = decode_tile_summary(encode(s));
    EXPECT_EQ(back.posts, s.posts);
    EXPECT_EQ(back.post_valid, s.post_valid);
    EXPECT_EQ(back.valid_samples, s.valid_samples);
    EXPECT_EQ(back.lowest, s.lowest);
    EXPECT_EQ(back.highest, s.highest);
    EXPECT_EQ(back.errors, s.errors);
    EXPECT_EQ(encode(back), encode(s)) << "the rest of it, too";
  }
}

TEST(TileSummary, TruncationsAndAnyBytesAreCorruptOrHarmless) {
  Random random(50);
  const std::vector<std::byte> bytes = encode(random_summary(random));
  const auto read = [](std::span<const std::byte> some) {
    try {
      static_cast<void>(decode_tile_summary(some));
      return true;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.cause(), Cause::corrupt);
      return false;
    }
  };
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 40)
    EXPECT_FALSE(read(std::span(bytes).first(size))) << size;
  for (int time = 0; time < 3000; ++time) {
    std::vector<std::byte> other = bytes;
    for (int flips = random.between(1, 4); flips > 0; --flips) {
      other[static_cast<std::size_t>(random.next() % other.size())] ^=
          static_cast<std::byte>(1 << random.between(0, 7));
    }
    static_cast<void>(read(other));
  }
  for (int time = 0; time < 1000; ++time) {
    std::vector<std::byte> any(random.next() % 600);
    for (std::byte& byte : any) byte = static_cast<std::byte>(random.next());
    static_cast<void>(read(any));
  }
}

}  // namespace
}  // namespace talus::support
