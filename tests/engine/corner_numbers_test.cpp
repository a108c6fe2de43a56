// The numbers of a square at multiples of 8.

#include "engine/page/corner_numbers.hpp"

#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

template <class T>
class CornerNumbers : public testing::Test {};
using Widths = testing::Types<std::uint16_t, std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(CornerNumbers, Widths);

/// Numbers within `bits` bits at corners, and 1 elsewhere.
template <class T>
std::vector<T> some_square(Random& random, int bits) {
  std::vector<T> square(kSquare, 1);
  for (std::size_t row = 0; row < 128; row += 8) {
    for (std::size_t col = 0; col < 128; col += 8)
      square[row * 128 + col] = bits == 0 ? T{7} : static_cast<T>(random.next() >> (64 - bits));
  }
  return square;
}

TYPED_TEST(CornerNumbers, ComeBackAndLeaveAllOthers) {
  constexpr int kBits = std::numeric_limits<TypeParam>::digits;
  for (int bits = 0; bits <= kBits; ++bits) {
    SCOPED_TRACE(bits);
    Random random(static_cast<std::uint64_t>(bits));
    const std::vector<TypeParam> square = some_square<TypeParam>(random, bits);
    std::vector<std::byte> bytes;
    put_corner_numbers(std::span<const TypeParam>(square), bytes);
    EXPECT_LE(bytes.size(), 16u + 32u * static_cast<unsigned>(std::min(bits + 1, kBits)));
    const std::size_t size = bytes.size();
    bytes.push_back(std::byte{0xff});  // others may follow
    std::vector<TypeParam> read(kSquare, 1);
    ASSERT_EQ(get_corner_numbers(std::span<const std::byte>(bytes), std::span(read)), size);
    ASSERT_EQ(read, square);
  }
}

TYPED_TEST(CornerNumbers, OfAPlaneTakeWhatTheirDocumentSays) {
  std::vector<TypeParam> square(kSquare, 0);
  for (std::size_t row = 0; row < 128; row += 8) {
    for (std::size_t col = 0; col < 128; col += 8)
      square[row * 128 + col] = static_cast<TypeParam>(3 - 2 * (col / 8));  // 3 from 0, then −2 each: 6 and 3
  }
  std::vector<std::byte> bytes;
  put_corner_numbers(std::span<const TypeParam>(square), bytes);
  ASSERT_EQ(bytes.size(), 16u + 2 * 3 + 15 * 2 * 2);
  EXPECT_EQ(bytes[0], std::byte{3});
  EXPECT_EQ(bytes[1], std::byte{0b11'011'110});
  EXPECT_EQ(bytes[7], std::byte{2}) << "the first number of later rows is that north of it";
  EXPECT_EQ(bytes[8], std::byte{0b11'11'11'00});
}

TYPED_TEST(CornerNumbers, TruncatedOrImpossibleAreRefused) {
  Random random(3);
  const std::vector<TypeParam> square = some_square<TypeParam>(random, 12);
  std::vector<std::byte> bytes;
  put_corner_numbers(std::span<const TypeParam>(square), bytes);
  std::vector<TypeParam> read(kSquare);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(get_corner_numbers(std::span<const std::byte>(cut), std::span(read)), 0u) << size;
  }
  bytes.resize(5000);
  bytes[0] = static_cast<std::byte>(std::numeric_limits<TypeParam>::digits + 1);
  EXPECT_EQ(get_corner_numbers(std::span<const std::byte>(bytes), std::span(read)), 0u);
}

}  // namespace
}  // namespace talus::support
