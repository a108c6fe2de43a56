// The candidates of levels as bytes: what was told is told again, level by level, and what is damaged is refused.

#include "engine/stream/level_symbols.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

using Bytes = std::vector<std::byte>;

TEST(LevelSymbols, StripesAreAllRowsOnceOfAboutAsManyEach) {
  for (const std::int32_t rows : {0, 1, 2, 7, 100, 268435456}) {
    for (const std::size_t stripes : {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{64}}) {
      EXPECT_EQ(stripe_row(rows, stripes, 0), 0);
      EXPECT_EQ(stripe_row(rows, stripes, stripes), rows);
      for (std::size_t b = 0; b < stripes; ++b) {
        const std::int64_t size = stripe_row(rows, stripes, b + 1) - stripe_row(rows, stripes, b);
        EXPECT_GE(size, rows / static_cast<std::int64_t>(stripes));
        EXPECT_LE(size, rows / static_cast<std::int64_t>(stripes) + 1);
      }
    }
  }
}

/// A row of candidates with what is told of them.
template <class Code>
struct Told {
  std::int32_t row = 0;
  std::vector<std::uint8_t> contexts, present;
  std::vector<Code> residuals;

  [[nodiscard]] CandidateRow<Code> as_row() {
    CandidateRow<Code> r;
    r.row = row;
    r.count = contexts.size();
    r.contexts = contexts.data();
    r.present = present.data();
    r.residuals = residuals.data();
    return r;
  }
};

/// The rows of a level by half and stripe.
template <class Code>
using Level = std::array<std::vector<std::vector<Told<Code>>>, 2>;

template <class Code>
Level<Code> random_level(Random& random) {
  using Limits = std::numeric_limits<Code>;
  Level<Code> level;
  const auto stripes = static_cast<std::size_t>(random.between(1, 4));
  const int contexts = random.chance(0.5) ? kCandidateContexts : random.between(1, 3);
  const double density = random.unit();
  // From residuals of a few codes to those of all bits.
  const int size = random.chance(0.2) ? 8 * static_cast<int>(sizeof(Code)) : random.between(1, 20);
  for (auto& half : level) {
    half.resize(stripes);
    for (auto& stripe : half) {
      for (int rows = random.between(0, 12); rows > 0; --rows) {
        Told<Code> told;
        told.row = random.between(0, 1000);
        for (int i = random.between(0, 70); i > 0; --i) {
          told.contexts.push_back(static_cast<std::uint8_t>(random.between(0, contexts - 1)));
          told.present.push_back(random.chance(density) ? 1 : 0);
          const auto any =
              static_cast<Code>(static_cast<Code>(random.next()) >> (8 * static_cast<int>(sizeof(Code)) - size));
          const Code extreme = random.chance(0.5) ? Limits::min() : Limits::max();
          told.residuals.push_back(told.present.back() == 0 ? Code{0} : random.chance(0.005) ? extreme : any);
        }
        stripe.push_back(std::move(told));
      }
    }
  }
  return level;
}

template <class Code>
Bytes encoded(LevelEncoder<Code>& encoder, Level<Code>& level) {
  std::array<std::vector<StripeRecord<Code>>, 2> records;
  for (std::size_t half = 0; half < 2; ++half) {
    records[half].resize(level[half].size());
    for (std::size_t b = 0; b < level[half].size(); ++b) {
      for (auto& told : level[half][b]) records[half][b].take(told.as_row());
    }
  }
  return encoder.encode(records);
}

/// What a decoder says of the same candidates. False: it refused the bytes.
template <class Code>
bool decoded(LevelDecoder<Code>& decoder, std::span<const std::byte> bytes, const Level<Code>& asked, Level<Code>& back,
             bool backward = false) {
  back = asked;
  try {
    const std::size_t stripes = decoder.start(bytes);
    if (!bytes.empty() && stripes != asked[0].size()) return false;
    for (std::size_t half = 0; half < 2; ++half) {
      for (std::size_t k = 0; k < back[half].size(); ++k) {
        const std::size_t b = backward ? back[half].size() - 1 - k : k;
        for (auto& told : back[half][b]) {
          std::fill(told.present.begin(), told.present.end(), std::uint8_t{77});
          std::fill(told.residuals.begin(), told.residuals.end(), Code{77});
          auto row = told.as_row();
          decoder.take(half, b, row);
        }
      }
    }
    return decoder.is_intact();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::corrupt);
    return false;
  }
}

template <class Code>
void expect_same(const Level<Code>& a, const Level<Code>& b) {
  for (std::size_t half = 0; half < 2; ++half) {
    for (std::size_t s = 0; s < a[half].size(); ++s) {
      for (std::size_t r = 0; r < a[half][s].size(); ++r) {
        const Told<Code>&one = a[half][s][r], &other = b[half][s][r];
        ASSERT_EQ(one.present, other.present);
        for (std::size_t i = 0; i < one.present.size(); ++i) {
          if (one.present[i] != 0) {
            ASSERT_EQ(one.residuals[i], other.residuals[i]);
          }
        }
      }
    }
  }
}

template <class Code>
bool has_vertices(const Level<Code>& level) {
  for (const auto& half : level) {
    for (const auto& stripe : half) {
      for (const auto& told : stripe) {
        if (std::find(told.present.begin(), told.present.end(), 1) != told.present.end()) return true;
      }
    }
  }
  return false;
}

template <class Code>
void expect_levels_come_back() {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    LevelEncoder<Code> encoder;
    LevelDecoder<Code> forward, backward;
    for (int levels = random.between(1, 6); levels > 0; --levels) {  // tables may serve the next level, too
      Level<Code> level = random_level<Code>(random), back;
      const Bytes bytes = encoded(encoder, level);
      EXPECT_EQ(bytes.empty(), !has_vertices(level));
      ASSERT_TRUE(decoded(forward, bytes, level, back));
      expect_same(back, level);
      ASSERT_TRUE(decoded(backward, bytes, level, back, true)) << "stripes in any order";
      expect_same(back, level);
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST(LevelSymbols, LevelsComeBackOneAfterTheOther) { expect_levels_come_back<std::int32_t>(); }
TEST(LevelSymbols, WideLevelsComeBackOneAfterTheOther) { expect_levels_come_back<std::int64_t>(); }

TEST(LevelSymbols, ALevelLikeTheOneBeforeUsesItsTables) {
  Random random(2);
  Level<std::int32_t> level = random_level<std::int32_t>(random);
  while (!has_vertices(level)) level = random_level<std::int32_t>(random);
  LevelEncoder<std::int32_t> encoder;
  const Bytes first = encoded(encoder, level), second = encoded(encoder, level);
  EXPECT_LT(second.size(), first.size());
  LevelDecoder<std::int32_t> decoder;
  Level<std::int32_t> back;
  EXPECT_FALSE(decoded(decoder, second, level, back)) << "without the tables it is damaged";
  ASSERT_TRUE(decoded(decoder, first, level, back));
  ASSERT_TRUE(decoded(decoder, second, level, back));
  expect_same(back, level);
}

/// Levels with vertices, one for each seed.
template <class Code, class Visit>
void for_each_encoded(std::uint64_t seeds, Visit&& visit) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Level<Code> level = random_level<Code>(random);
    if (!has_vertices(level)) continue;
    LevelEncoder<Code> encoder;
    visit(random, encoded(encoder, level), level);
  }
}

TEST(LevelSymbols, EveryTruncationIsRefused) {
  for_each_encoded<std::int32_t>(10, [](Random&, const Bytes& bytes, const Level<std::int32_t>& level) {
    Level<std::int32_t> back;
    for (std::size_t size = 1; size < bytes.size(); ++size) {  // no bytes at all: every candidate is absent
      LevelDecoder<std::int32_t> decoder;
      EXPECT_FALSE(decoded(decoder, std::span(bytes).first(size), level, back)) << size << " of " << bytes.size();
    }
    Bytes longer = bytes;
    longer.push_back(std::byte{0});
    LevelDecoder<std::int32_t> decoder;
    EXPECT_FALSE(decoded(decoder, longer, level, back));
  });
}

TEST(LevelSymbols, AStripeThatIsNotReadToItsEndIsDamaged) {
  for_each_encoded<std::int32_t>(40, [](Random&, const Bytes& bytes, const Level<std::int32_t>& level) {
    Level<std::int32_t> fewer = level, back;
    auto& rows = fewer[0][0];
    while (!rows.empty() && rows.back().contexts.empty()) rows.pop_back();
    // The last row that has a vertex is not asked for.
    std::size_t vertices = 0;
    while (!rows.empty() && vertices == 0) {
      vertices = static_cast<std::size_t>(std::count(rows.back().present.begin(), rows.back().present.end(), 1));
      rows.pop_back();
    }
    if (vertices < 20) return;
    LevelDecoder<std::int32_t> decoder;
    EXPECT_FALSE(decoded(decoder, bytes, fewer, back));
  });
}

TEST(LevelSymbols, AShiftOfMoreBitsThanACodeHasIsRefused) {
  Level<std::int32_t> level;  // small residuals only: nothing is read but symbols
  for (auto& half : level) {
    Told<std::int32_t> told;
    for (int i = 0; i < 50; ++i) {
      told.contexts.push_back(0);
      told.present.push_back(i % 2 == 0 ? 1 : 0);
      told.residuals.push_back(i % 4 == 0 ? 1 : 0);
    }
    half = {{told}};
  }
  LevelEncoder<std::int32_t> encoder;
  Bytes bytes = encoded(encoder, level);
  ASSERT_EQ(bytes[1], std::byte{0}) << "the shift stands behind the number of stripes";
  for (const int shift : {32, 63, 64, 255}) {
    bytes[1] = static_cast<std::byte>(shift);
    LevelDecoder<std::int32_t> decoder;
    EXPECT_THROW(static_cast<void>(decoder.start(bytes)), Failure) << shift;
  }
}

template <class Code>
void expect_any_bytes_are_harmless() {
  int refused = 0;
  for_each_encoded<Code>(40, [&](Random& random, const Bytes& bytes, const Level<Code>& level) {
    for (int time = 0; time < 60; ++time) {
      Bytes other = bytes;
      if (time % 3 == 0) {
        other.resize(static_cast<std::size_t>(random.between(1, 200)));
        for (std::byte& byte : other) byte = static_cast<std::byte>(random.next());
      }
      for (int flips = random.between(1, 4); flips > 0; --flips)
        other[static_cast<std::size_t>(random.next() % other.size())] ^= static_cast<std::byte>(random.between(1, 255));
      LevelDecoder<Code> decoder;
      Level<Code> back;
      if (!decoded(decoder, other, level, back)) {
        ++refused;
        continue;
      }
      for (const auto& half : back) {
        for (const auto& stripe : half) {
          for (const auto& told : stripe) {
            for (const std::uint8_t p : told.present) ASSERT_LE(p, 1);
          }
        }
      }
    }
  });
  EXPECT_GT(refused, 700);
}

TEST(LevelSymbols, AnyBytesAreRefusedOrHarmless) {
  expect_any_bytes_are_harmless<std::int32_t>();
  expect_any_bytes_are_harmless<std::int64_t>();
}

}  // namespace
}  // namespace talus::support
