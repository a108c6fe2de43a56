// Bits, distributions and symbols of streams: what was written is read, and no bytes make a reader leave its bounds.

#include "engine/stream/symbol_coder.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

using Bytes = std::vector<std::byte>;

Bytes random_bytes(Random& random, int most) {
  Bytes bytes(static_cast<std::size_t>(random.between(0, most)));
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.next());
  return bytes;
}

TEST(Bits, AreReadAsTheyWereWritten) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    struct Put {
      int count;  // 0: a gamma
      std::uint64_t bits;
    };
    std::vector<Put> puts;
    BitWriter out;
    for (int i = random.between(0, 300); i > 0; --i) {
      const int count = random.between(0, 64);
      const std::uint64_t bits = count == 0    ? (1 + random.next() % 0xffffffffu) >> random.between(0, 31)
                                 : count == 64 ? random.next()
                                               : random.next() & ((std::uint64_t{1} << count) - 1);
      puts.push_back({count, count == 0 && bits == 0 ? 1 : bits});
      if (count == 0) {
        out.put_gamma(static_cast<std::uint32_t>(puts.back().bits));
      } else {
        out.put(bits, count);
      }
    }
    out.finish();
    BitReader in(out.bytes);
    for (const Put& put : puts) {
      ASSERT_EQ(put.count == 0 ? std::uint64_t{in.take_gamma()} : in.take_long(put.count), put.bits) << put.count;
    }
    EXPECT_TRUE(in.is_intact());
    if (!out.bytes.empty()) {
      BitReader cut(std::span(out.bytes).first(out.bytes.size() - 1));
      for (const Put& put : puts) static_cast<void>(put.count == 0 ? cut.take_gamma() : cut.take_long(put.count));
      EXPECT_FALSE(cut.is_intact());
    }
  }
}

struct Sent {
  std::vector<std::uint8_t> contexts, symbols;
  std::vector<std::size_t> rows;  ///< their lengths
  std::vector<SymbolTables::Counts> counts;

  [[nodiscard]] std::vector<SymbolRow> as_rows() const {
    std::vector<SymbolRow> all;
    std::size_t at = 0;
    for (const std::size_t size : rows) {
      all.push_back({std::span(contexts).subspan(at, size), std::span(symbols).subspan(at, size)});
      at += size;
    }
    return all;
  }
};

Sent random_symbols(Random& random) {
  Sent sent;
  const int kinds = random.between(1, 34);
  sent.counts.resize(static_cast<std::size_t>(kinds));
  std::vector<int> most(static_cast<std::size_t>(kinds));
  for (int& m : most) m = random.chance(0.2) ? 0 : random.between(0, kMostSymbols - 1);
  for (int row = random.between(0, 40); row > 0; --row) {
    sent.rows.push_back(static_cast<std::size_t>(random.between(0, 90)));
    for (std::size_t i = 0; i < sent.rows.back(); ++i) {
      const auto context = static_cast<std::size_t>(random.between(0, kinds - 1));
      const int symbol = std::min(random.between(0, most[context]), random.between(0, most[context]));
      sent.contexts.push_back(static_cast<std::uint8_t>(context));
      sent.symbols.push_back(static_cast<std::uint8_t>(symbol));
      ++sent.counts[context][static_cast<std::size_t>(symbol)];
    }
  }
  return sent;
}

SymbolTables sent_tables(const Sent& sent) {
  const SymbolTables tables = SymbolTables::of(sent.counts);
  BitWriter out;
  tables.write(out);
  out.finish();
  BitReader in(out.bytes);
  SymbolTables back;
  EXPECT_TRUE(back.read(in, sent.counts.size()));
  EXPECT_TRUE(in.is_intact());
  return back;
}

TEST(Symbols, AreReadAsTheyWereWrittenAndTablesTravel) {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Sent sent = random_symbols(random);
    const SymbolTables tables = sent_tables(sent);
    const Bytes bytes = encode_symbols(SymbolTables::of(sent.counts), sent.as_rows());
    SymbolReader in(tables, bytes);
    for (const SymbolRow& row : sent.as_rows()) {
      std::vector<std::uint8_t> symbols(row.symbols.size());
      in.take(row.contexts.data(), symbols.data(), symbols.size());
      ASSERT_TRUE(std::equal(symbols.begin(), symbols.end(), row.symbols.begin()));
    }
    EXPECT_TRUE(in.is_intact());
    // The cost that is announced is about what they take: four states of 4 bytes, and rounding.
    EXPECT_LE(static_cast<double>(bytes.size()), tables.cost(sent.counts) / 8 * 1.01 + 24);
  }
}

TEST(Symbols, ATruncationIsNeverReadAsWhole) {
  Random random(9);
  Sent sent = random_symbols(random);
  while (sent.symbols.size() < 500) sent = random_symbols(random);
  const SymbolTables tables = sent_tables(sent);
  const Bytes bytes = encode_symbols(tables, sent.as_rows());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    SymbolReader in(tables, std::span(bytes).first(size));
    std::vector<std::uint8_t> symbols(sent.symbols.size());
    std::size_t at = 0;
    for (const std::size_t row : sent.rows) {
      in.take(sent.contexts.data() + at, symbols.data() + at, row);
      at += row;
    }
    EXPECT_FALSE(in.is_intact() && symbols == sent.symbols) << size;
  }
}

TEST(Symbols, AnyBytesAreReadWithinBounds) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    const Bytes bytes = random_bytes(random, 400);
    BitReader bits(bytes);
    SymbolTables tables;
    const std::size_t contexts = static_cast<std::size_t>(random.between(1, 34));
    if (!tables.read(bits, contexts)) {
      const std::vector<SymbolTables::Counts> counts(contexts, [] {
        SymbolTables::Counts c{};
        c[3] = 5, c[77] = 1;
        return c;
      }());
      tables = SymbolTables::of(counts);
    }
    const Bytes coded = random_bytes(random, 300);
    SymbolReader in(tables, coded);
    std::vector<std::uint8_t> under(500), symbols(500);
    for (std::uint8_t& context : under) context = static_cast<std::uint8_t>(random.next() % contexts);
    in.take(under.data(), symbols.data(), symbols.size());
    for (const std::uint8_t symbol : symbols) EXPECT_LT(symbol, kMostSymbols);
    static_cast<void>(in.is_intact());
  }
}

}  // namespace
}  // namespace talus::support
