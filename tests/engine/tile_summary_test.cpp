// The record of a tile: what was written is read, and no bytes are taken that no record has.

#include "engine/tile/tile_summary.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
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
  const auto real = [&] { return static_cast<float>(random.within(-400, 9000)); };
  const auto code = [&] { return static_cast<ErrorCode>(random.next()); };
  for (TileRecord::Block& b : s.record.blocks) {
    b.error = code();
    b.holds = static_cast<std::uint8_t>(random.between(0, 15));
    b.has_data = random.chance(0.8);
    b.middle = real(), b.right = real(), b.down = real(), b.above = real(), b.below = real();
    b.bits = {static_cast<std::int16_t>(random.between(-30, 0)), static_cast<std::int16_t>(random.between(0, 30))};
    b.typical = random.within(-400, 9000);
  }
  for (ErrorCode& e : s.record.errors) e = code();
  for (std::uint8_t& h : s.record.holds) h = static_cast<std::uint8_t>(random.next());
  s.entry = {random.chance(0.5), code(), real(), real(), static_cast<std::uint32_t>(random.next())};
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
    EXPECT_EQ(back.entry, s.entry);
    EXPECT_EQ(back.record.errors, s.record.errors);
    EXPECT_EQ(back.record.holds, s.record.holds);
    for (std::size_t i = 0; i < s.record.blocks.size(); ++i) {
      const TileRecord::Block &a = back.record.blocks[i], &b = s.record.blocks[i];
      EXPECT_EQ(a.error, b.error);
      EXPECT_EQ(a.holds, b.holds);
      EXPECT_EQ(a.has_data, b.has_data);
      EXPECT_EQ((std::array{a.middle, a.right, a.down, a.above, a.below}),
                (std::array{b.middle, b.right, b.down, b.above, b.below}));
      EXPECT_EQ(a.bits, b.bits);
      EXPECT_EQ(a.typical, b.typical);
    }
    EXPECT_EQ(encode(back), encode(s)) << "the same record is the same bytes";
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

TEST(TileSummary, ANumberThatIsNoneIsCorrupt) {
  Random random(51);
  for (int field = 0; field < 3; ++field) {
    TileSummary s = random_summary(random);
    if (field == 0) s.posts[17] = std::nan("");
    if (field == 1) s.record.blocks[200].above = std::nanf("");
    if (field == 2) s.lowest = std::nan("");
    EXPECT_THROW(static_cast<void>(decode_tile_summary(encode(s))), Failure) << field;
  }
  TileSummary without = random_summary(random);
  without.lowest = std::numeric_limits<double>::infinity(), without.highest = -without.lowest;
  EXPECT_EQ(decode_tile_summary(encode(without)).highest, without.highest) << "of a tile without data";
}

TEST(TileSummary, RungsAreOneTwoAndFiveADecadeFromAMillimetre) {
  const std::vector<double> expected{0,  0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1,  0.2,  0.5,   1,     2,    5,
                                     10, 20,    50,    100,   200,  500,  1000, 2000, 5000, 10000, 20000, 50000};
  ASSERT_EQ(expected.size(), kErrorRungs);
  for (std::size_t i = 0; i < kErrorRungs; ++i) EXPECT_EQ(error_rung(i), expected[i]);
}

}  // namespace
}  // namespace talus::support
