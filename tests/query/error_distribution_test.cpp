#include "query/accuracy/error_distribution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus {
namespace {

/// By sorting all of them.
double sorted_within(std::vector<double> all, double share) {
  std::sort(all.begin(), all.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(all.size())));
  return all[std::max<std::size_t>(rank, 1) - 1];
}

double plain_rms(const std::vector<double>& all) {
  double squares = 0;
  for (const double v : all) squares += v * v;
  return std::sqrt(squares / static_cast<double>(all.size()));
}

TEST(ErrorDistribution, IsThatOfSortingAllOfThem) {
  support::Random random(5);
  for (int round = 0; round < 40; ++round) {
    ErrorDistribution found, other;
    std::vector<double> all;
    const int count = random.between(1, 3000);
    for (int i = 0; i < count; ++i) {
      const double v = random.chance(0.1) ? 0.0 : std::pow(10, random.within(-14.0, 7.0));
      all.push_back(v);
      (i % 3 == 0 ? other : found).add(v);
    }
    found += other;
    EXPECT_EQ(found.samples(), all.size());
    EXPECT_EQ(found.largest(), *std::max_element(all.begin(), all.end()));
    EXPECT_NEAR(found.rms(), plain_rms(all), 1e-9 * plain_rms(all));
    for (const double share : {0.001, 0.5, 0.95, 0.999, 1.0}) {
      const double exact = sorted_within(all, share), within = found.within(share);
      EXPECT_GE(within, exact) << share;
      EXPECT_LE(within, std::max(exact * (1 + 1.0 / 256), exact < 1e-12 ? 1e-12 : 0)) << share;
      EXPECT_TRUE(std::find(all.begin(), all.end(), within) != all.end()) << "no sample is that far off";
    }
    EXPECT_EQ(found.within(1), found.largest());
  }
}

TEST(ErrorDistribution, OfWholeAndHalfMetresIsExact) {
  support::Random random(6);
  ErrorDistribution found;
  std::vector<double> all;
  for (int i = 0; i < 5000; ++i) {
    all.push_back(0.5 * random.between(0, 100));
    found.add(all.back());
  }
  for (int percent = 1; percent <= 100; ++percent)
    EXPECT_EQ(found.within(percent / 100.0), sorted_within(all, percent / 100.0));
}

TEST(ErrorDistribution, OfNothingIsZeroAndOfInfinityInfinite) {
  ErrorDistribution none;
  EXPECT_EQ(none.samples(), 0u);
  EXPECT_EQ(none.largest(), 0);
  EXPECT_EQ(none.rms(), 0);
  EXPECT_EQ(none.within(0.95), 0);
  none += ErrorDistribution{};
  EXPECT_EQ(none.within(0.95), 0);
  none.add(1);
  none.add(std::numeric_limits<double>::infinity());
  EXPECT_EQ(none.within(0.5), 1);
  EXPECT_TRUE(std::isinf(none.within(0.95)));
  EXPECT_TRUE(std::isinf(none.rms()));
}

}  // namespace
}  // namespace talus
