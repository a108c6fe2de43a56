// Which float sources become whole numbers, and that every value comes back bit for bit.

#include "ingest/height_step.hpp"

#include <bit>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

Description source(const char* type, bool integer = false) {
  Description d;
  d.source_type = type;
  d.step.integer = integer;
  return d;
}

struct Found {
  HeightStep step;
  std::vector<double> codes;
};
Found find(const char* type, std::vector<double> values, std::vector<std::uint8_t> valid = {}) {
  valid.resize(values.size(), 1);
  const HeightStep step = find_height_step(source(type), values, valid);
  return {step, values};
}

TEST(HeightStep, WholeNumbersInFloatsAreWholeNumbers) {
  for (const char* type : {"Float32", "Float64"}) {
    const Found found = find(type, {1, -7, 0, 8848});
    EXPECT_EQ(found.step, (HeightStep{1, 1, 0, true}));
    EXPECT_EQ(found.codes, (std::vector<double>{1, -7, 0, 8848}));
  }
}

TEST(HeightStep, DecimalsOfUpToThreePlacesInDoublesAreWholeNumbersOverAPowerOfTen) {
  EXPECT_EQ(find("Float64", {0.1, 2.5, -3}).step, (HeightStep{1, 10, 0, true}));
  EXPECT_EQ(find("Float64", {0.1, 2.25}).step, (HeightStep{1, 100, 0, true}));
  EXPECT_EQ(find("Float64", {0.125, 1234.567}).step, (HeightStep{1, 1000, 0, true}));
  EXPECT_EQ(find("Float64", {0.1, 2.5, -3}).codes, (std::vector<double>{1, 25, -30}));
}

TEST(HeightStep, FourPlacesStayFloats) {
  const Found found = find("Float64", {0.1234, 1});
  EXPECT_FALSE(found.step.integer);
  EXPECT_EQ(found.codes, (std::vector<double>{0.1234, 1}));
}

TEST(HeightStep, DecimalsInSingleFloatsStayFloats) {
  const double tenth = static_cast<double>(0.1F);
  const Found found = find("Float32", {tenth, 2.5});
  EXPECT_FALSE(found.step.integer);
  EXPECT_EQ(found.codes, (std::vector<double>{tenth, 2.5}));
}

TEST(HeightStep, AnUlpBesideADecimalIsNoDecimal) {
  EXPECT_FALSE(find("Float64", {0.1, std::nextafter(0.3, 1)}).step.integer);
}

TEST(HeightStep, NegativeZeroIsNoWholeNumberForItWouldLoseItsSign) {
  const Found found = find("Float64", {1, -0.0});
  EXPECT_FALSE(found.step.integer);
  EXPECT_TRUE(std::signbit(found.codes[1]));
}

TEST(HeightStep, VoidsHaveNoSay) {
  const Found found = find("Float64", {1.5, 0.123456, std::nan("")}, {1, 0, 0});
  EXPECT_EQ(found.step, (HeightStep{1, 10, 0, true}));
  EXPECT_EQ(found.codes, (std::vector<double>{15, 0, 0}));
}

TEST(HeightStep, WhatIsWholeAlreadyKeepsItsStep) {
  Description d = source("Int16", true);
  d.step = {0.5, 1, -100, true};
  std::vector<double> codes{1, 2, 3};
  EXPECT_EQ(find_height_step(d, codes, {1, 1, 1}), d.step);
  EXPECT_EQ(codes, (std::vector<double>{1, 2, 3}));
}

TEST(HeightStep, EveryStepRestoresEveryValueBitForBit) {
  Random random(1);
  for (int round = 0; round < 400; ++round) {
    const double power = std::pow(10, random.between(0, 4));
    std::vector<double> values;
    for (int i = 0; i < 200; ++i) values.push_back(random.between(-999999999, 999999999) / 1000 / power);
    const Found found = find("Float64", values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(found.step.value(found.codes[i])),
                std::bit_cast<std::uint64_t>(values[i]));
      ASSERT_TRUE(!found.step.integer || found.codes[i] == std::nearbyint(found.codes[i]));
    }
    EXPECT_TRUE(found.step.integer || power > 1000) << "over " << power;
  }
}

}  // namespace
}  // namespace talus::support
