// Heights of a stream as whole numbers: back bit for bit, and what has no code is refused.

#include "engine/stream/height_codes.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

HeightCoding coding_of(const Description& d, const std::vector<double>& heights, Metres quantum = Metres{0},
                       Metres tolerance = Metres{1}) {
  const std::span<const double> all = heights;
  return HeightCoding::of(d, quantum, tolerance, {&all, 1});
}

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
    d.minimum_height = -500, d.maximum_height = 4000;
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

TEST(StreamHeights, HaveTheNarrowestKindThatHoldsThemAll) {
  const Description d;
  EXPECT_EQ(coding_of(d, {1, -7, 1e9}).kind, CodeKind::whole);
  EXPECT_FALSE(coding_of(d, {1, -7, 1e9}).is_wide);
  EXPECT_FALSE(coding_of(d, {(1 << 30) - 1.0}).is_wide);
  EXPECT_TRUE(coding_of(d, {double{1 << 30}}).is_wide);
  EXPECT_TRUE(coding_of(d, {-double{1 << 30}}).is_wide);
  EXPECT_EQ(coding_of(d, {1, 0.5}).kind, CodeKind::floats);
  EXPECT_EQ(coding_of(d, {1, -0.0}).kind, CodeKind::floats) << "no whole number has this sign";
  EXPECT_FALSE(coding_of(d, {1e10, 0.5}).is_wide);
  EXPECT_EQ(coding_of(d, {1, 0.1}).kind, CodeKind::doubles);
  EXPECT_TRUE(coding_of(d, {1, 0.1}).is_wide);
  Description tenths;
  tenths.step = {1, 10, -3.5, true};
  EXPECT_EQ(coding_of(tenths, {tenths.step.value(17), tenths.step.value(-1)}).kind, CodeKind::whole);
  EXPECT_EQ(coding_of(tenths, {tenths.step.value(17), 0.01}).kind, CodeKind::doubles);
}

TEST(StreamHeights, CodesRiseWithHeights) {
  for (const bool narrow : {true, false}) {
    std::vector<double> heights{-1e30, -2.5, -1, -0.0, 0.0, 1e-30, 1, 2.5, 1e30};
    for (double& h : heights) h = narrow ? static_cast<double>(static_cast<float>(h)) : h;
    if (!narrow) heights.push_back(1e300);
    const HeightCoding coding = coding_of({}, heights);
    ASSERT_EQ(coding.kind, narrow ? CodeKind::floats : CodeKind::doubles);
    const auto codes = codes_of<std::int64_t>(coding, heights);
    ASSERT_TRUE(codes);
    for (std::size_t i = 1; i < codes->size(); ++i) EXPECT_LT((*codes)[i - 1], (*codes)[i]) << heights[i];
  }
}

TEST(StreamHeights, TheToleranceIsCountedInCodes) {
  Description d;
  d.metres_per_unit = 0.5;
  d.step = {4, 2, 0, true};  // a code is 2 units, a metre
  EXPECT_EQ(coding_of(d, {2, 4}, Metres{0}, Metres{3}).tolerance, 3);
  EXPECT_EQ(coding_of(d, {0.25, 0.5}, Metres{0.125}, Metres{3}).tolerance, 24) << "in quanta";
  d.minimum_height = -3, d.maximum_height = 1000;  // floats next to each other at 1000 lie 2^-14 apart, doubles 2^-43
  EXPECT_EQ(coding_of(d, {0.3F}, Metres{0}, Metres{3}).tolerance, 6 * 16384);
  EXPECT_EQ(coding_of(d, {0.3}, Metres{0}, Metres{3}).tolerance, std::ldexp(6, 43));
}

TEST(StreamHeights, AHeaderSaysTheSame) {
  StreamHeader header;
  header.description.step = {0.25, 1, 7, true};
  header.description.maximum_height = 300;
  header.quadtree.tolerance = Metres{3};
  for (const double quantum : {0.0, 0.5}) {
    const std::vector<double> heights{quantum > 0 ? 2.5 : header.description.step.value(9)};
    const HeightCoding said = coding_of(header.description, heights, Metres{quantum}, header.quadtree.tolerance);
    header.kind = said.kind;
    header.is_wide = said.is_wide;
    header.quadtree.origin.quantum = Metres{quantum};
    const HeightCoding read = HeightCoding::of(header);
    EXPECT_EQ(read.kind, quantum > 0 ? CodeKind::quanta : CodeKind::whole);
    EXPECT_EQ(read.step, said.step);
    EXPECT_EQ(read.tolerance, said.tolerance);
    EXPECT_EQ(read.is_wide, said.is_wide);
  }
}

TEST(StreamHeights, RefuseWhatIsNoNumberOrNoMultipleOfTheQuantum) {
  for (const double h : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity})
    EXPECT_THROW(static_cast<void>(coding_of({}, {1, h})), Failure) << h;
  EXPECT_THROW(static_cast<void>(coding_of({}, {0.5, 0.75}, Metres{0.5})), Failure);
  EXPECT_NO_THROW(static_cast<void>(coding_of({}, {0.5, 1}, Metres{0.5})));
}

TEST(StreamHeights, AHeightWithoutACodeHasNone) {
  HeightCoding coding;
  EXPECT_FALSE(codes_of<std::int32_t>(coding, std::vector<double>{1, 1.5}));
  EXPECT_FALSE(codes_of<std::int32_t>(coding, std::vector<double>{double{1 << 30}}));
  EXPECT_TRUE(codes_of<std::int64_t>(coding, std::vector<double>{double{1 << 30}}));
  EXPECT_FALSE(codes_of<std::int64_t>(coding, std::vector<double>{3e15})) << "next to it numbers lie too far apart";
  coding.kind = CodeKind::floats;
  EXPECT_FALSE(codes_of<std::int32_t>(coding, std::vector<double>{0.1}));
  coding.kind = CodeKind::doubles;
  EXPECT_FALSE(codes_of<std::int32_t>(coding, std::vector<double>{0.1}));
}

TEST(StreamHeights, OfAnyCodesAreFiniteOrCorrupt) {
  Random random(3);
  int refused = 0, read = 0;
  for (int time = 0; time < 20000; ++time) {
    HeightCoding coding;
    coding.kind = static_cast<CodeKind>(random.between(0, 3));
    coding.step = {random.chance(0.5) ? 1.0 : 1e300, 1, 0, true};
    const std::vector<std::int64_t> codes{0, static_cast<std::int64_t>(random.next())};
    try {
      const Array<double> heights = heights_of<std::int64_t>(coding, codes);
      ASSERT_TRUE(std::isfinite(heights[0]) && std::isfinite(heights[1]));
      ++read;
    } catch (const Failure& failure) {
      ASSERT_EQ(failure.cause(), Cause::corrupt);
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(read, 100);
}

}  // namespace
}  // namespace talus::support
