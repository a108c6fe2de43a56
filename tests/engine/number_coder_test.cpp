// Numbers under contexts: what was written is read, in whatever portions, and no bytes make a reader leave its bounds.

#include "engine/page/number_coder.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

using Bytes = std::vector<std::byte>;

struct Numbers {
  std::vector<std::uint64_t> values;
  std::vector<std::uint8_t> contexts;
};

/// Each context has sizes of its own: bits that numbers take at most.
Numbers random_numbers(Random& random, std::size_t count, int most_bits) {
  std::vector<int> bits(kContexts);
  for (int& b : bits) b = random.between(0, most_bits);
  Numbers numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const int context = random.between(0, kContexts - 1), length = bits[static_cast<std::size_t>(context)];
    const std::uint64_t mask = length >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << length) - 1;
    numbers.values.push_back(random.next() & mask & (random.chance(0.5) ? ~std::uint64_t{0} : random.next()));
    numbers.contexts.push_back(static_cast<std::uint8_t>(context));
  }
  return numbers;
}

Bytes written(const Numbers& numbers) {
  NumberWriter out;
  for (std::size_t i = 0; i < numbers.values.size(); ++i) out.put(numbers.values[i], numbers.contexts[i]);
  Bytes bytes;
  out.finish(bytes);
  return bytes;
}

TEST(NumberCoder, GivesBackWhatWasPut) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int most_bits = seed % 3 == 0 ? 64 : seed % 3 == 1 ? 32 : 6;
    const Numbers numbers = random_numbers(random, static_cast<std::size_t>(random.between(0, 3000)), most_bits);
    NumberReader in;
    in.start(written(numbers));
    for (std::size_t i = 0; i < numbers.values.size(); ++i)
      ASSERT_EQ(in.get(numbers.contexts[i]), numbers.values[i]) << i;
    EXPECT_TRUE(in.is_intact());
  }
}

TEST(NumberCoder, ATruncationOrAFlippedBitIsNeverReadAsWhole) {
  Random random(71);
  const Numbers numbers = random_numbers(random, 400, 20);
  const Bytes bytes = written(numbers);
  const auto read = [&](const Bytes& some) {
    NumberReader in;
    in.start(some);
    std::vector<std::uint64_t> values;
    for (const std::uint8_t context : numbers.contexts) values.push_back(in.get(context));
    return std::pair(in.is_intact(), values);
  };
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(read({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}).first) << size;
  }
  for (int time = 0; time < 2000; ++time) {
    Bytes other = bytes;
    other[static_cast<std::size_t>(random.between(0, static_cast<int>(bytes.size()) - 1))] ^=
        static_cast<std::byte>(1 << random.between(0, 7));
    EXPECT_NE(read(other), std::pair(true, numbers.values)) << "a bit that means nothing";
  }
}

TEST(NumberCoder, AnyBytesAreReadWithinBounds) {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    Random random(seed);
    Bytes bytes(static_cast<std::size_t>(random.between(0, 300)));
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.next());
    NumberReader in;
    in.start(bytes);
    const int context = random.between(0, kContexts - 1);
    for (int i = 0; i < 512; ++i) static_cast<void>(in.get(context));
    static_cast<void>(in.get(0));
    static_cast<void>(in.is_intact());
  }
}

}  // namespace
}  // namespace talus::support
