// Implied errors in 16 bits and the selection of their bits, for every set of instructions: against the errors in 32
// bits, which have tests of their own, and against a loop over samples.

#include "engine/dense/eighths_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/dense/kernels.hpp"
#include "engine/dense/square_bits.hpp"
#include "engine/page/page_errors.hpp"
#include "tests/support/random.hpp"
#include "tests/support/random_raster.hpp"

namespace talus::support {
namespace {

using detail::EighthsFound;
using detail::SortedSquare;
using detail::SquarePart;

constexpr int kSide = kPageSide;

/// Heights whose differences in a page stay below 4000, around any base.
std::vector<std::int16_t> some_heights(Random& random) {
  std::vector<std::int16_t> heights(kSquare);
  const int base = random.between(-32768, 32767);
  const double rough = random.log_between(0.1, 1400), wave = random.within(0, 500);
  for (std::size_t i = 0; i < kSquare; ++i) {
    const double h = wave * std::sin(static_cast<double>(i % kSide) / 9) + random.within(-rough, rough);
    heights[i] = static_cast<std::int16_t>(static_cast<std::uint16_t>(base + static_cast<int>(std::floor(h))));
  }
  return heights;
}

/// The heights, so that none wraps around.
std::vector<std::int32_t> unwrapped(const std::vector<std::int16_t>& heights) {
  std::vector<std::int32_t> wide(heights.size());
  std::transform(heights.begin(), heights.end(), wide.begin(), [&](std::int16_t h) {
    return std::int32_t{static_cast<std::int16_t>(static_cast<std::uint16_t>(h - heights.front()))};
  });
  return wide;
}

TEST(Eighths, AreTheErrorsIn32BitsForEveryKernel) {
  ImpliedErrors<std::int32_t> by_32_bits;
  const auto sorted = std::make_unique<SortedSquare>();
  const auto errors = std::make_unique<SortedSquare>();
  for (int seed = 0; seed < property_cases(40); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const std::vector<std::int16_t> heights = some_heights(random);
    std::vector<std::int32_t> expected(kSquare);
    by_32_bits.compute(unwrapped(heights), PresentRect{}, {}, expected);
    for (const InstructionSet set : instruction_sets_here()) {
      *errors = {};
      detail::eighths_kernel(set).compute(heights.data(), *errors, *sorted);
      int compared = 0;
      for (int row = 0; row < kSide; ++row) {
        for (int col = 0; col < kSide; ++col) {
          if (!is_implied_by_place(col, row, PresentRect{})) continue;
          ++compared;
          ASSERT_EQ(errors->numbers[SortedSquare::index_of(col, row)],
                    expected[static_cast<std::size_t>(row * kSide + col)])
              << to_string(set) << " at " << col << ", " << row;
        }
      }
      ASSERT_GT(compared, 15000);
    }
  }
}

/// The selection, sample by sample.
EighthsFound selected_by_samples(const SortedSquare& errors, std::int16_t threshold, const SquarePart& part,
                                 std::vector<bool>& is_selected) {
  EighthsFound found;
  is_selected.assign(kSquare, false);
  for (int row = part.first_row; row <= part.last_row; ++row) {
    for (int col = part.first_col; col <= part.last_col; ++col) {
      if (((col | row) & 7) == 0) continue;
      const std::int16_t error = errors.numbers[SortedSquare::index_of(col, row)];
      const int level = ((col | row) & 1) != 0 ? 0 : ((col | row) & 2) != 0 ? 1 : 2;
      std::int16_t& largest = error > threshold ? found.largest_selected[level] : found.largest_absent;
      largest = std::max(largest, error);
      is_selected[static_cast<std::size_t>(row * kSide + col)] = error > threshold;
    }
  }
  return found;
}

TEST(Eighths, SelectWhatIsAboveInAnyPartOfASquareForEveryKernel) {
  const auto errors = std::make_unique<SortedSquare>();
  for (int seed = 0; seed < property_cases(120); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int most = random.between(1, 32767);
    for (std::int16_t& error : errors->numbers) error = static_cast<std::int16_t>(random.between(-1, most));
    SquarePart part;
    if (random.chance(0.7)) {
      part.first_col = random.between(0, kSide - 1);
      part.last_col = random.between(part.first_col, kSide - 1);
      part.first_row = random.between(0, kSide - 1);
      part.last_row = random.between(part.first_row, kSide - 1);
    }
    const int choice = random.between(0, 9);
    const auto threshold = static_cast<std::int16_t>(choice == 0 ? -1 : choice == 1 ? 32767 : random.between(-1, most));
    std::vector<bool> expected;
    const EighthsFound by_samples = selected_by_samples(*errors, threshold, part, expected);
    for (const InstructionSet set : instruction_sets_here()) {
      std::uint64_t rows[kSide][2];
      std::fill_n(&rows[0][0], 2 * kSide, std::uint64_t{0x123456789});
      const EighthsFound found = detail::eighths_kernel(set).select(*errors, threshold, part, rows);
      EXPECT_EQ(found.largest_absent, by_samples.largest_absent) << to_string(set);
      for (int level = 0; level < 3; ++level)
        EXPECT_EQ(found.largest_selected[level], by_samples.largest_selected[level]) << to_string(set);
      for (std::size_t i = 0; i < kSquare; ++i)
        ASSERT_EQ((rows[i / kSide][i % kSide / 64] >> (i % 64) & 1) != 0, expected[i]) << to_string(set) << " at " << i;
    }
  }
}

TEST(Eighths, GatherTheNumbersOfAllBitsRowByRowForEveryKernel) {
  std::vector<std::int16_t> square(kSquare);
  for (int seed = 0; seed < property_cases(60); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::int16_t& number : square) number = static_cast<std::int16_t>(random.between(-32768, 32767));
    const double share = seed == 0 ? 0 : seed == 1 ? 1 : random.log_between(0.001, 1);
    SquareBits bits{};
    std::vector<std::int16_t> expected;
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col) {
        if (!random.chance(share)) continue;
        insert(bits, col, row);
        expected.push_back(square[static_cast<std::size_t>(row * kSide + col)]);
      }
    }
    for (const InstructionSet set : instruction_sets_here()) {
      SCOPED_TRACE(static_cast<int>(set));
      std::vector<std::int16_t> gathered(expected.size() + 33, 77);
      ASSERT_EQ(detail::eighths_kernel(set).gather(square.data(), bits.data(), gathered.data()),
                static_cast<int>(expected.size()));
      EXPECT_EQ(gathered.back(), 77) << "at most 32 numbers behind the last one are written";
      gathered.resize(expected.size());
      ASSERT_EQ(gathered, expected);
    }
  }
}

}  // namespace
}  // namespace talus::support
