// Numbers of dense pages: what is stored comes back, all kernels write and read the same, and refuse the same bytes.

#include "engine/dense/dense_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/dense/dense_plain.hpp"
#include "engine/dense/kernels.hpp"
#include "tests/support/random.hpp"
#include "tests/support/random_raster.hpp"

namespace talus::support {
namespace {

constexpr int kSide = detail::kDenseSide;
constexpr std::size_t kSquare = std::size_t{kSide} * kSide;

template <class T>
using Square = std::vector<T>;

bool is_known(std::size_t i) { return ((i % kSide | i / kSide) & 7) == 0; }
bool is_stored(const std::optional<SquareBits>& stored, std::size_t i) {
  return !stored || ((*stored)[i / kSide][i % kSide / 64] >> (i % 64) & 1) != 0;
}

template <class T>
struct Coder {
  std::string name;
  DenseNumbers<T> numbers;
};

/// The one by the book first.
template <class T>
std::vector<Coder<T>> coders() {
  std::vector<Coder<T>> all;
  all.push_back({"plain", DenseNumbers<T>(detail::kPlainDense<T>)});
  for (const InstructionSet set : instruction_sets_here())
    all.push_back({std::string(to_string(set)), DenseNumbers<T>(detail::dense_functions<T>(set))});
  return all;
}

enum class Ground { flat, smooth, hills, spikes, noise, steps, all_values };
constexpr int kGrounds = 7;

template <class T>
Square<T> some_ground(Ground ground, Random& random) {
  Square<T> square(kSquare);
  const double phase = random.within(0, 100), rough = ground == Ground::hills ? random.within(0.3, 40) : 0;
  const double large = ground == Ground::noise ? std::pow(2.0, random.within(1, 8.0 * sizeof(T) - 2)) : 0;
  for (std::size_t i = 0; i < kSquare; ++i) {
    const auto x = static_cast<double>(i % kSide), y = static_cast<double>(i / kSide);
    double height = ground == Ground::flat ? 7 : 900 * std::sin((x + phase) / 50) - 400 * std::cos((y - phase) / 30);
    if (ground == Ground::steps) height = std::floor(height / 100) * 100;
    if (rough > 0) height += random.within(-rough, rough);
    if (large > 0) height = random.within(-large, large);
    square[i] = static_cast<T>(static_cast<std::int64_t>(std::floor(height)));
    if (ground == Ground::all_values || (ground == Ground::spikes && random.chance(0.001)))
      square[i] = static_cast<T>(random.next());
  }
  return square;
}

/// Nothing: all numbers are stored. Else the south-east is missing, and some numbers, or some columns.
std::optional<SquareBits> some_stored(Random& random) {
  if (random.chance(0.4)) return std::nullopt;
  SquareBits stored{};
  const auto cols = random.between(1, kSide), rows = random.between(1, kSide);
  const double missing = random.chance(0.5) ? 0 : random.within(0, 1);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x) {
      if (!random.chance(missing)) stored[static_cast<std::size_t>(y)][x / 64] |= std::uint64_t{1} << (x % 64);
    }
  }
  return stored;
}

template <class T>
struct Written {
  std::optional<SquareBits> stored;
  Square<T> original, square;  ///< the second: as put() left it
  std::vector<std::byte> bytes;

  [[nodiscard]] const SquareBits* stored_bits() const { return stored ? &*stored : nullptr; }
  [[nodiscard]] Square<T> known() const {
    Square<T> known(kSquare, 0x55);
    for (std::size_t i = 0; i < kSquare; ++i) {
      if (is_known(i)) known[i] = original[i];
    }
    return known;
  }
};

template <class T>
Written<T> written(Coder<T>& coder, const Square<T>& original, const std::optional<SquareBits>& stored) {
  Written<T> made{stored, original, original, {}};
  coder.numbers.put(made.square, made.stored_bits(), made.bytes);
  return made;
}

template <class T>
class DenseNumbersOf : public testing::Test {};
using Widths = testing::Types<std::uint16_t, std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(DenseNumbersOf, Widths);

TYPED_TEST(DenseNumbersOf, WhatIsStoredComesBackFromEveryKernelAndAllWriteTheSameBytes) {
  using T = TypeParam;
  std::vector<Coder<T>> all = coders<T>();
  for (int seed = 0; seed < property_cases(60); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Square<T> original = some_ground<T>(static_cast<Ground>(seed % kGrounds), random);
    const Written<T> by_the_book = written(all.front(), original, some_stored(random));
    for (std::size_t i = 0; i < kSquare; ++i) {
      if (is_known(i) || is_stored(by_the_book.stored, i)) {
        ASSERT_EQ(by_the_book.square[i], original[i]) << i;
      }
    }
    for (Coder<T>& coder : all) {
      const Written<T> again = written(coder, original, by_the_book.stored);
      ASSERT_TRUE(again.bytes == by_the_book.bytes) << coder.name;
      ASSERT_TRUE(again.square == by_the_book.square) << coder.name;
      Square<T> read = by_the_book.known();
      ASSERT_TRUE(coder.numbers.get(by_the_book.bytes, by_the_book.stored_bits(), read)) << coder.name;
      ASSERT_TRUE(read == by_the_book.square) << coder.name;
    }
  }
}

template <class T>
std::vector<std::byte> damaged(std::vector<std::byte> bytes, Random& random) {
  const auto place = [&](std::size_t end) {
    return static_cast<std::size_t>(random.between(0, static_cast<int>(end) - 1));
  };
  switch (random.between(0, 3)) {
    case 0: bytes.resize(place(bytes.size() + 1)); break;
    case 1: bytes.insert(bytes.end(), 1 + place(40), std::byte{0xff}); break;
    case 2:  // in the head, where sizes and parameters are
      for (std::size_t k = place(4) + 1; k > 0; --k)
        bytes[place(std::min<std::size_t>(30, bytes.size()))] ^= std::byte{1} << place(8);
      break;
    default:
      for (std::size_t k = place(8) + 1; k > 0; --k) bytes[place(bytes.size())] ^= std::byte{1} << place(8);
  }
  return bytes;
}

TYPED_TEST(DenseNumbersOf, AllKernelsRefuseTheSameDamagedBytes) {
  using T = TypeParam;
  std::vector<Coder<T>> all = coders<T>();
  int refused = 0, accepted = 0;
  for (int seed = 0; seed < property_cases(28); ++seed) {
    Random random(seed + 1000);
    const Square<T> original = some_ground<T>(static_cast<Ground>(seed % kGrounds), random);
    const Written<T> whole = written(all.front(), original, some_stored(random));
    for (int i = 0; i < 24; ++i) {
      SCOPED_TRACE(testing::Message() << seed << ", damage " << i);
      const std::vector<std::byte> bytes = damaged<T>(whole.bytes, random);
      Square<T> first = whole.known();
      const bool verdict = all.front().numbers.get(bytes, whole.stored_bits(), first);
      ++(verdict ? accepted : refused);
      for (Coder<T>& coder : all) {
        Square<T> read = whole.known();
        ASSERT_EQ(coder.numbers.get(bytes, whole.stored_bits(), read), verdict) << coder.name;
        if (verdict) {
          ASSERT_TRUE(read == first) << coder.name;
        }
      }
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(accepted, 10);  // a changed low bit is another number
}

TEST(DenseNumbers, FlatGroundCostsAFlagForSixteenNumbersOrLess) {
  Square<std::uint16_t> square(kSquare, 1234);
  std::vector<std::byte> bytes;
  DenseNumbers<std::uint16_t>().put(square, nullptr, bytes);
  EXPECT_LE(bytes.size(), 160u);  // 1008 groups
}

TEST(DenseNumbers, APlaneCostsWhatFlatGroundCosts) {
  Square<std::uint16_t> flat(kSquare, 1234), plane(kSquare);
  for (std::size_t i = 0; i < kSquare; ++i)
    plane[i] = static_cast<std::uint16_t>(900 + 3 * (i % kSide) - 5 * (i / kSide));
  std::vector<std::byte> of_flat, of_plane;
  DenseNumbers<std::uint16_t>().put(flat, nullptr, of_flat);
  DenseNumbers<std::uint16_t>().put(plane, nullptr, of_plane);
  EXPECT_TRUE(of_flat == of_plane);
}

TEST(DenseNumbers, AFlatSquareHasNoFlags) {
  const Square<std::uint16_t> flat(kSquare, 70);
  for (Coder<std::uint16_t>& coder : coders<std::uint16_t>()) {
    SCOPED_TRACE(coder.name);
    Square<std::uint16_t> square = flat;
    std::vector<std::byte> bytes;
    coder.numbers.put(square, nullptr, bytes);
    EXPECT_EQ(bytes.size(), 25u) << "the head";
    for (std::size_t i = 0; i < kSquare; ++i) square[i] = is_known(i) ? flat[i] : std::uint16_t{9};
    EXPECT_TRUE(coder.numbers.get(bytes, nullptr, square));
    EXPECT_TRUE(square == flat);
    // With unary parts or low bits it is damage: no group reads them.
    bytes.push_back(std::byte{1});
    EXPECT_FALSE(coder.numbers.get(bytes, nullptr, square));
    bytes[4] = std::byte{1};
    EXPECT_FALSE(coder.numbers.get(bytes, nullptr, square));
  }
}

TEST(DenseNumbers, ASpikeCostsAsMuchAsAPatch) {
  Square<std::uint16_t> square(kSquare, 0);
  std::vector<std::byte> flat, spike;
  DenseNumbers<std::uint16_t>().put(square, nullptr, flat);
  square[std::size_t{65} * kSide + 65] = 30000;
  DenseNumbers<std::uint16_t>().put(square, nullptr, spike);
  EXPECT_LT(spike.size(), flat.size() + detail::kDenseGroups / 8 + 200);  // it also spoils the predictions around it
}

TEST(DenseNumbers, AMissingSquareHasNoBytesButTheHead) {
  Square<std::uint16_t> square(kSquare, 5);
  const SquareBits stored{};
  std::vector<std::byte> bytes;
  DenseNumbers<std::uint16_t>().put(square, &stored, bytes);
  EXPECT_LE(bytes.size(), 32u);
  EXPECT_EQ(square, Square<std::uint16_t>(kSquare, 5)) << "predicted from what is known";
}

TEST(DenseNumbers, NoiseCostsHardlyMoreThanItsBits) {
  Random random(3);
  const Square<std::uint32_t> original = some_ground<std::uint32_t>(Ground::all_values, random);
  Square<std::uint32_t> square = original;
  std::vector<std::byte> bytes;
  DenseNumbers<std::uint32_t>().put(square, nullptr, bytes);
  EXPECT_LT(static_cast<double>(bytes.size()), 1.07 * 4 * kSquare);
}

}  // namespace
}  // namespace talus::support
