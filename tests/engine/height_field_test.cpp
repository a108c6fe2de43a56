// Heights as the error computation sees them: codes, distances and the bits that numbers use.

#include "engine/error/height_field.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

TEST(HeightField, CodesOfEveryTypeAreSeenAsNumbers) {
  EXPECT_EQ(code_at(view(Codes(std::vector<std::int16_t>{3, -32768})), 1), -32768);
  EXPECT_EQ(code_at(view(Codes(std::vector<float>{0.5F, 0.1F})), 1), static_cast<double>(0.1F));
  EXPECT_EQ(code_at(view(Codes(std::vector<double>{0.5, 0.1})), 1), 0.1);
}

TEST(HeightField, SamplesStandRowByRowFromTheCornerOfTheExtent) {
  const std::vector<std::int16_t> heights{0, 1, 2, 3, 4, 5};
  const std::vector<std::uint8_t> valid{1, 1, 0, 1, 1, 1};
  const HeightField field{{{-1, 7}, {1, 8}}, std::span(heights), valid, {}};
  EXPECT_EQ((field[{-1, 7}]), 0);
  EXPECT_EQ((field[{1, 7}]), 2);
  EXPECT_EQ((field[{-1, 8}]), 3);
  EXPECT_FALSE(field.is_valid(field.index({1, 7})));
  EXPECT_TRUE(field.is_valid(field.index({-1, 8})));
  EXPECT_TRUE((HeightField{{{0, 0}, {2, 1}}, std::span(heights), {}, {}}.is_valid(2))) << "all are";
}

TEST(HeightField, DistancesInCodesBecomeMetresWithoutTheRoundingOfATenth) {
  EXPECT_EQ(CodeDistance().metres(7), 7);
  EXPECT_EQ(CodeDistance({1, 10, -50, true}, 1).metres(3), 0.3);
  EXPECT_EQ(CodeDistance({0.1, 1, 0, true}, 1).metres(3), 0.3) << "a tenth is divided by ten";
  EXPECT_EQ(CodeDistance({-0.1, 1, 0, true}, 1).metres(3), 0.3) << "distances have no sign";
  EXPECT_EQ(CodeDistance({2, 1, 0, true}, 0.3048).metres(1), 0.6096);
  EXPECT_EQ(CodeDistance({0.3, 1, 0, true}, 1).metres(10), 3);
  for (const double scale : {0.25, 0.5, 1.0, 4.0})
    EXPECT_TRUE(CodeDistance({scale, 1, 0, true}, 1).is_binary()) << scale;
  for (const double scale : {0.1, 0.3, 3.0}) EXPECT_FALSE(CodeDistance({scale, 1, 0, true}, 1).is_binary()) << scale;
  EXPECT_FALSE(CodeDistance({1, 1, 0, true}, 0.3048).is_binary());
  EXPECT_FALSE(CodeDistance({1, 10, 0, true}, 1).is_binary());
}

/// Heights in steps of nanometres: doubles no longer hold the eighths of metres one by one.
TEST(HeightField, ErrorsCountInEighthsUpToThirtyOneBits) {
  const CodeDistance whole({1, 1, 0, true}, 1);
  EXPECT_EQ(whole.eighths(0), 0);
  EXPECT_EQ(whole.eighths(0.125), 1);
  EXPECT_EQ(whole.eighths(std::nextafter(0.125, 1)), 2);
  EXPECT_EQ(whole.eighths((kMostEighths - 1) / 8.0), kMostEighths - 1);
  EXPECT_EQ(whole.eighths(kMostEighths / 8.0), kMostEighths);
  EXPECT_EQ(whole.eighths(1e300), kMostEighths);
  EXPECT_EQ(whole.up_to_eighths(error_code(0.3)), 0.375);
  for (const double scale : {1e-9, 1e-7, 1e-5, 1e-3, 0.1, 0.3, 1.0, 7.0, 1e9}) {
    SCOPED_TRACE(scale);
    const CodeDistance distance({scale, 1, 0, true}, 1);
    for (int code = 0; code <= int{kAlwaysSelected}; code += 7) {
      const double error = error_of(static_cast<ErrorCode>(code));
      const std::int32_t eighths = distance.eighths(error);
      if (eighths == kMostEighths) {
        EXPECT_EQ(distance.up_to_eighths(static_cast<ErrorCode>(code)), error);
        continue;
      }
      EXPECT_GE(distance.metres(eighths / 8.0), error);
      EXPECT_TRUE(eighths == 0 || distance.metres((eighths - 1) / 8.0) < error);
    }
  }
}

BitRange bits_of(const std::vector<double>& numbers) {
  BitRange bits;
  for (const double h : numbers) bits.take(h);
  return bits;
}

TEST(BitRange, IsTheLowestAndTheHighestBitOfAllNumbers) {
  EXPECT_EQ(bits_of({}), BitRange{});
  EXPECT_EQ(bits_of({0, -0.0}), BitRange{}) << "zeros use none";
  EXPECT_EQ(bits_of({1}), (BitRange{0, 0}));
  EXPECT_EQ(bits_of({-12}), (BitRange{2, 3})) << "8 + 4";
  EXPECT_EQ(bits_of({0.75, 1024}), (BitRange{-2, 10}));
  EXPECT_EQ(bits_of({0.1}).finest, -55);
  BitRange both = bits_of({0.75});
  both.take(bits_of({1024}));
  EXPECT_EQ(both, bits_of({0.75, 1024}));
  both.take(BitRange{});
  EXPECT_EQ(both, bits_of({0.75, 1024}));
  Random random(1);
  for (int time = 0; time < 2000; ++time) {
    const int low = random.between(-300, 300), width = random.between(0, 51);
    const double h = std::ldexp(1, low) + (width > 0 ? std::ldexp(1, low + width) : 0);
    EXPECT_EQ(bits_of({random.chance(0.5) ? h : -h}),
              (BitRange{static_cast<std::int16_t>(low), static_cast<std::int16_t>(low + width)}));
  }
}

TEST(BitRange, InterpolatesExactlyWhereADoubleHoldsAllThatIsBetween) {
  EXPECT_TRUE(BitRange{}.interpolates_exactly(1 << 20));
  EXPECT_TRUE(bits_of({32767, -32768}).interpolates_exactly(1024));
  EXPECT_FALSE(bits_of({0.1, 0.2}).interpolates_exactly(2));
  for (const double h : {std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::quiet_NaN()})
    EXPECT_FALSE(bits_of({1, h}).interpolates_exactly(2)) << h;
  // Where it says so, sums of three corners by weights in fractions of the side are the same in wider numbers.
  Random random(2);
  int exact = 0;
  for (int time = 0; time < 20000; ++time) {
    const int shift = random.between(1, 10), side = 1 << shift, bits = random.between(20, 50);
    const auto any = [&] { return static_cast<double>(static_cast<std::int64_t>(random.next() >> (64 - bits))); };
    const double a = any(), b = any(), c = any();
    if (!bits_of({a, b, c}).interpolates_exactly(side)) continue;
    ++exact;
    const int x = random.between(0, side), y = random.between(0, side - x);
    const double right = (b - a) / side, down = (c - a) / side;
    const long double wide = static_cast<long double>(a) +
                             (static_cast<long double>(b) - static_cast<long double>(a)) * x / side +
                             (static_cast<long double>(c) - static_cast<long double>(a)) * y / side;
    ASSERT_EQ(static_cast<long double>(a + down * y + right * x), wide);
  }
  EXPECT_GT(exact, 5000);
}

}  // namespace
}  // namespace talus::support
