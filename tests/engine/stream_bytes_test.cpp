// Numbers of a stream as bytes: what was put is taken, each truncation is refused, and checksums are chained.

#include "engine/stream/stream_bytes.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int v : values) bytes.push_back(static_cast<std::byte>(v));
  return bytes;
}

TEST(StreamBytes, AreLittleEndian) {
  StreamWriter out;
  out.put(std::uint32_t{0x04030201});
  out.put(std::int16_t{-2});
  out.put(1.0);
  out.put(GridRect{{1, -1}, {2, 3}});
  out.put(std::string("ab"));
  EXPECT_EQ(out.bytes, bytes_of({1, 2, 3,    4,    0xfe, 0xff, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 1,   0,
                                 0, 0, 0xff, 0xff, 0xff, 0xff, 2, 0, 0, 0, 3, 0, 0,    0,    'a', 'b'}));
}

struct Example {
  std::uint8_t one = 200;
  std::int64_t two = std::numeric_limits<std::int64_t>::min();
  double three = -0.0;
  GridRect four{{-7, 8}, {9, 1 << 30}};
  std::string five = "höhe";
};
Bytes written(const Example& e) {
  StreamWriter out;
  out.put(e.one), out.put(e.two), out.put(e.three), out.put(e.four), out.put(e.five);
  const Bytes raw{std::byte{3}};
  out.put(std::span<const std::byte>(raw));
  return out.bytes;
}
void expect_example(StreamTaker& in) {
  const Example e;
  EXPECT_EQ(in.take<std::uint8_t>(), e.one);
  EXPECT_EQ(in.take<std::int64_t>(), e.two);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(in.take<double>()), std::bit_cast<std::uint64_t>(e.three));
  EXPECT_EQ(in.rect(), e.four);
  EXPECT_EQ(in.text(e.five.size()), e.five);
  EXPECT_EQ(in.take(1)[0], std::byte{3});
}

TEST(StreamBytes, WhatWasPutIsTakenAndEachTruncationSaysAtWhichByte) {
  const Bytes bytes = written({});
  StreamTaker in(bytes, 1000);
  expect_example(in);
  EXPECT_EQ(in.left(), 0u);
  EXPECT_EQ(in.at(), bytes.size());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    StreamTaker cut(std::span<const std::byte>(bytes).first(size), 1000);
    try {
      expect_example(cut);
      ADD_FAILURE() << size << " bytes are taken for all";
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.cause(), Cause::corrupt);
      EXPECT_THAT(failure.what(), ::testing::HasSubstr("byte " + std::to_string(1000 + size)));
    }
  }
  StreamTaker in_front(bytes);
  EXPECT_THROW(static_cast<void>(in_front.take(std::numeric_limits<std::uint64_t>::max())), Failure);
}

TEST(StreamBytes, EachSealDependsOnAllThatCameBefore) {
  const auto sealed = [](int first, int second) {
    StreamWriter out;
    out.put(first);
    out.seal(0);
    const std::size_t begin = out.bytes.size();
    out.put(second);
    out.seal_short(begin);
    return out.bytes;
  };
  const Bytes bytes = sealed(1, 2);
  ASSERT_EQ(bytes.size(), 4u + 8 + 4 + 4);
  StreamTaker in(bytes);
  const std::uint64_t first = stream_checksum(in.take(4), 0);
  EXPECT_EQ(in.take<std::uint64_t>(), first);
  const std::uint64_t second = stream_checksum(in.take(4), first);
  EXPECT_EQ(in.take<std::uint32_t>(), static_cast<std::uint32_t>(second));
  const Bytes other = sealed(3, 2);
  EXPECT_NE(Bytes(other.end() - 4, other.end()), Bytes(bytes.end() - 4, bytes.end())) << "after another first one";
}

TEST(StreamBytes, LengthsComeBackAndTruncationsAreCorrupt) {
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const std::uint64_t value = random.next() >> random.between(1, 63);
    Bytes bytes;
    put_variable(bytes, value);
    EXPECT_EQ(VariableReader(bytes).value(), value);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      VariableReader cut(std::span<const std::byte>(bytes).first(size));
      EXPECT_THROW(static_cast<void>(cut.value()), Failure);
    }
  }
  const Bytes endless(20, std::byte{255});
  VariableReader in(endless);
  EXPECT_THROW(static_cast<void>(in.value()), Failure);
}

TEST(StreamBytes, PiecesAreTakenBehindTheirLengthsAndNotBeyondTheEnd) {
  Bytes bytes;
  put_variable(bytes, 300);
  EXPECT_EQ(bytes, bytes_of({0xac, 0x02})) << "seven bits each, the low ones first";
  bytes.resize(2 + 300, std::byte{7});
  VariableReader in(bytes);
  EXPECT_EQ(in.take(in.size()).size(), 300u);
  EXPECT_EQ(in.left(), 0u);
  VariableReader cut(std::span<const std::byte>(bytes).first(301));
  const std::size_t size = cut.size();
  EXPECT_THROW(static_cast<void>(cut.take(size)), Failure);
}

}  // namespace
}  // namespace talus::support
