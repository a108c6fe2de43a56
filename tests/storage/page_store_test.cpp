// Pages in a file: what went in comes out, in order, and damage is noticed.

#include "storage/page_store.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/page/page_layout.hpp"
#include "storage/checksum.hpp"
#include "storage/tile_value.hpp"
#include "talus/failure.hpp"
#include "tests/support/older_database.hpp"
#include "tests/support/random.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;
using Pages = std::map<PageKey, Bytes>;

Bytes random_bytes(Random& random, std::size_t size) {
  Bytes bytes(size);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random.next() & 0xff);
  return bytes;
}

Bytes copy(const StoredPage& page) { return {page.content.begin(), page.content.end()}; }

void write(const fs::path& file, const Pages& pages) {
  PageWriter writer(file);
  for (const auto& [key, bytes] : pages) writer.put(key, bytes);
  const std::uint64_t bytes = writer.finish();
  EXPECT_EQ(bytes, fs::file_size(file));
}

Pages random_pages(Random& random, int count, int most_bytes) {
  Pages pages;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t position =
        random.chance(0.5) ? random.next() : static_cast<std::uint64_t>(random.between(0, 300));
    const auto size =
        static_cast<std::size_t>(random.chance(0.2) ? random.between(0, 10) : random.between(0, most_bytes));
    pages[{random.between(kHeaderTable, kSliceTable), position}] = random_bytes(random, size);
  }
  return pages;
}

void expect_holds(const ReadTxn& txn, const Pages& pages) {
  for (const auto& [key, bytes] : pages) {
    const auto found = txn.find(key);
    ASSERT_TRUE(found.has_value()) << "table " << key.table << ", position " << key.position;
    EXPECT_EQ(copy(*found), bytes);
  }
}

Cause cause_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Failure& failure) {
    EXPECT_STRNE(failure.what(), "");
    return failure.cause();
  }
  ADD_FAILURE() << "did not fail";
  return Cause{};
}

// ---- what goes in comes out ------------------------------------------------------------------------

TEST(PageStore, AgreesWithAMap) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const TempFolder folder;
    const Pages pages = random_pages(random, 300, seed == 1 ? 100000 : 6000);
    write(folder / "a.talus", pages);
    const ReadTxn txn(PageStore::open(folder / "a.talus"));
    expect_holds(txn, pages);
    for (int table = kHeaderTable; table <= kSliceTable; ++table) {
      std::vector<std::uint64_t> expected, found;
      std::uint64_t bytes = 0;
      std::set<std::uint64_t> tiles;
      for (const auto& [key, page] : pages) {
        // The directories of all tiles count for table 1.
        const std::uint64_t tile = value_key(key).position;
        if (table == 1 && is_of_tile(key.table) && tiles.insert(tile).second) bytes += kTileDirectoryBytes;
        if (key.table != table) continue;
        expected.push_back(key.position);
        bytes += page.size() + kPagePrefixBytes;
      }
      txn.for_each(table, [&](std::uint64_t position) { found.push_back(position); });
      EXPECT_EQ(found, expected) << "table " << table << ": order, or what is there";
      EXPECT_EQ(txn.summary(table).pages, expected.size());
      EXPECT_EQ(txn.summary(table).bytes, bytes);
    }
    EXPECT_EQ(txn.file_bytes(), fs::file_size(folder / "a.talus"));
    for (int i = 0; i < 200; ++i) {
      const PageKey key{random.between(kHeaderTable, 31), random.next()};
      EXPECT_EQ(txn.find(key).has_value(), pages.contains(key));
    }
    EXPECT_EQ(check_structure(folder / "a.talus"), std::vector<std::string>{});
  }
}

TEST(PageStore, TakesPositionsOutOfOrder) {
  const TempFolder folder;
  Pages pages;
  Random random(9);
  {
    PageWriter writer(folder / "a.talus");
    for (const std::uint64_t position : {7u, 3u, 9u, 1u, 8u, 0u}) {
      for (const PageKey key : {PageKey{1, position}, PageKey{0, 64 * position + 5}}) {
        pages[key] = random_bytes(random, 3000);
        writer.put(key, pages[key]);
      }
    }
    writer.finish();
  }
  const ReadTxn txn(PageStore::open(folder / "a.talus"));
  expect_holds(txn, pages);
  for (const int table : {0, 1}) {
    std::vector<std::uint64_t> order;
    txn.for_each(table, [&](std::uint64_t position) { order.push_back(position); });
    EXPECT_EQ(order.size(), 6u);
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  }
}

TEST(PageStore, ATileIsReplacedAsAWhole) {
  const TempFolder folder;
  Random random(11);
  const Bytes a = random_bytes(random, 500), b = random_bytes(random, 700);
  {
    PageWriter writer(folder / "a.talus");
    for (const std::uint64_t i : {0u, 1u, 63u, 64u}) writer.put({0, kSigns + i}, a);
    for (const int table : {1, kSliceTable, kRecordTable}) writer.put({table, kSigns}, a);
    writer.commit(true);
    writer.put({kSliceTable, kSigns}, b, 7);
    writer.put({0, kSigns + 1}, b, 7);
    writer.finish();
  }
  const ReadTxn txn(PageStore::open(folder / "a.talus"));
  EXPECT_FALSE(txn.find({0, kSigns + 0}).has_value());
  EXPECT_FALSE(txn.find({0, kSigns + 63}).has_value());
  EXPECT_EQ(copy(*txn.find({0, kSigns + 1})), b);
  EXPECT_EQ(txn.find({0, kSigns + 1})->generation, 7u);
  EXPECT_EQ(copy(*txn.find({kSliceTable, kSigns + 0})), b);
  EXPECT_EQ(copy(*txn.find({0, kSigns + 64})), a) << "another tile";
  EXPECT_TRUE(txn.has({0, kSigns + 1}));
  EXPECT_FALSE(txn.has({0, kSigns + 5})) << "its tile is there, it is not";
  EXPECT_FALSE(txn.has({1, kSigns + 0}) || txn.has({kRecordTable, kSigns + 0}));
  EXPECT_FALSE(txn.has({0, kSigns + 128}));
}

TEST(PageStore, WhatWasForgottenIsReadAnew) {
  const TempFolder folder;
  Random random(12);
  const Pages pages = random_pages(random, 60, 20000);
  write(folder / "a.talus", pages);
  const ReadTxn txn(PageStore::open(folder / "a.talus"));
  expect_holds(txn, pages);
  for (const auto& [key, bytes] : pages) txn.forget(key);
  expect_holds(txn, pages);
}

TEST(PageStore, PositionsAreOrderedAsNumbersNotAsLittleEndianBytes) {
  const TempFolder folder;
  write(folder / "a.talus",
        {{{4, 0x01'00}, {}}, {{4, 0x00'ff}, {}}, {{4, 0xff'00'00'00'00'00'00'00u}, {}}, {{4, 0x02'00}, {}}});
  std::vector<std::uint64_t> order;
  ReadTxn(PageStore::open(folder / "a.talus")).for_each(4, [&](std::uint64_t position) { order.push_back(position); });
  EXPECT_EQ(order, (std::vector<std::uint64_t>{0xff, 0x100, 0x200, 0xff00000000000000u}));
}

TEST(PageStore, GrowsBeyondItsFirstMap) {
  const TempFolder folder;
  Random random(1);
  const Bytes page = random_bytes(random, 1 << 20);
  std::uint64_t bytes = 0;
  {
    PageWriter writer(folder / "a.talus");
    for (std::uint64_t i = 0; i < 80; ++i) {
      writer.put({1, i}, page);
      writer.commit();
    }
    bytes = writer.finish();
  }
  EXPECT_GT(bytes, std::uint64_t{80} << 20);
  const ReadTxn txn(PageStore::open(folder / "a.talus"));
  EXPECT_EQ(txn.summary(1).pages, 80u);
  for (const std::uint64_t i : {0u, 15u, 16u, 63u, 79u}) EXPECT_EQ(copy(*txn.find({1, i})), page);
  EXPECT_EQ(check_structure(folder / "a.talus"), std::vector<std::string>{});
}

TEST(PageStore, AnEmptyFileOfPagesOpens) {
  const TempFolder folder;
  write(folder / "a.talus", {});
  const ReadTxn txn(PageStore::open(folder / "a.talus"));
  EXPECT_FALSE(txn.find({0, 0}).has_value());
  EXPECT_EQ(txn.summary(0).pages, 0u);
}

TEST(PageStore, OpeningTheSameFileTwiceSharesOneEnvironment) {
  const TempFolder folder;
  Random random(2);
  const Pages pages = random_pages(random, 50, 2000);
  write(folder / "a.talus", pages);
  fs::create_symlink(folder / "a.talus", folder / "b.talus");
  const PageStore one = PageStore::open(folder / "a.talus"), two = PageStore::open(folder / "b.talus");
  EXPECT_EQ(two.file(), one.file()) << "the second opening is the first one's environment";
  const ReadTxn first(one), second(two);
  const PageKey key = pages.begin()->first;
  EXPECT_EQ(first.find(key)->content.data(), second.find(key)->content.data()) << "one map";
  expect_holds(second, pages);
}

TEST(PageStore, AViewOutlivesTheStoreItCameFrom) {
  const TempFolder folder;
  Random random(3);
  const Pages pages = random_pages(random, 20, 2000);
  write(folder / "a.talus", pages);
  ReadTxn txn(PageStore::open(folder / "a.talus"));
  const ReadTxn moved(std::move(txn));
  expect_holds(moved, pages);
}

TEST(PageStore, FourThreadsReadAtOnce) {
  const TempFolder folder;
  Random random(4);
  const Pages pages = random_pages(random, 200, 3000);
  write(folder / "a.talus", pages);
  const PageStore store = PageStore::open(folder / "a.talus");
  const ReadTxn shared(store);
  std::vector<std::size_t> wrong(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    threads.emplace_back([&, i] {
      const ReadTxn own(PageStore::open(folder / "a.talus"));
      for (int round = 0; round < 20; ++round) {
        for (const auto& [key, bytes] : pages) {
          wrong[i] += copy(*own.find(key)) != bytes || copy(*shared.find(key)) != bytes ? 1 : 0;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<std::size_t>(4));
}

// ---- damage ----------------------------------------------------------------------------------------

Bytes read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}
void write_file(const fs::path& file, std::span<const std::byte> bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// A file with one page of known content, and where that lies in it.
struct Known {
  TempFolder folder;
  Bytes content, bytes;
  std::size_t at = 0;
  explicit Known(std::size_t size) {
    Random random(6);
    content = random_bytes(random, size);
    write(folder / "a.talus", {{{2, 5}, content}, {{2, 6}, random_bytes(random, 50)}});
    bytes = read_file(folder / "a.talus");
    const auto found = std::search(bytes.begin(), bytes.end(), content.begin(), content.end());
    EXPECT_NE(found, bytes.end());
    at = static_cast<std::size_t>(found - bytes.begin());
  }
};

TEST(PageStore, ADamagedPageIsCorruptAndItsNeighbourIsNot) {
  for (const std::size_t size : {100u, 9000u}) {
    const Known known(size);
    for (const std::size_t at : {known.at, known.at + size - 1, known.at - 1, known.at - kPagePrefixBytes}) {
      Bytes bytes = known.bytes;
      bytes[at] ^= std::byte{0x10};
      const fs::path file = known.folder / ("b" + std::to_string(at));
      write_file(file, bytes);
      const ReadTxn txn(PageStore::open(file));
      EXPECT_EQ(cause_of([&] { static_cast<void>(txn.find({2, 5})); }), Cause::corrupt) << at - known.at;
      EXPECT_TRUE(txn.find({2, 6}).has_value());
    }
  }
}

TEST(PageStore, APageStoredUnderAnotherKeyIsCorrupt) {
  // The key stands before the value: position 5 becomes 4, which keeps the order.
  const Known known(100);
  Bytes bytes = known.bytes;
  const std::size_t last_of_key = known.at - kPagePrefixBytes - 1;
  ASSERT_EQ(bytes[last_of_key], std::byte{5});
  bytes[last_of_key] = std::byte{4};
  write_file(known.folder / "b.talus", bytes);
  const ReadTxn txn(PageStore::open(known.folder / "b.talus"));
  EXPECT_FALSE(txn.find({2, 5}).has_value());
  EXPECT_EQ(cause_of([&] { static_cast<void>(txn.find({2, 4})); }), Cause::corrupt);
}

TEST(PageStore, ChecksumsDifferByTablePositionAndGeneration) {
  const Bytes content(10, std::byte{1});
  EXPECT_EQ(page_checksum({2, 5}, 0, content), page_checksum({2, 5}, 0, content));
  EXPECT_NE(page_checksum({2, 5}, 0, content), page_checksum({3, 5}, 0, content));
  EXPECT_NE(page_checksum({2, 5}, 0, content), page_checksum({2, 6}, 0, content));
  EXPECT_NE(page_checksum({2, 5}, 0, content), page_checksum({2, 5}, 1, content));
  EXPECT_NE(page_checksum({kHeaderTable, 0}, 0, content), page_checksum({0, 0}, 0, content));
}

/// Whatever order its parts are put in, a tile has them in one order: the slice and the page of band 1 first, then the
/// pages along its west side, those along its north side, the others, and the record.
/// A page of band 0 belongs to the tile of the page above it, wherever that is.
TEST(PageStore, ATileHasThePagesBelowItsPageOfBand1) {
  Random random(17);
  for (int i = 0; i < 1000; ++i) {
    const int most = 1 << random.between(1, 28);
    const PageId tile{1, random.between(-most, most), random.between(-most, most)};
    for (std::size_t k = 0; k < kTilePages; ++k) {
      const std::uint64_t page = curve_position(child_page(tile, k));
      ASSERT_EQ(tile_of(page), curve_position(tile)) << tile.x << '/' << tile.y;
      ASSERT_EQ(position_in_tile(0, curve_position(tile), page % kTilePages), page);
    }
  }
}

TEST(PageStore, ATileHasItsPartsInTheOrderInWhichTheyAreRead) {
  const TempFolder folder;
  constexpr std::uint64_t kTile = kSigns | 3;  // at 1/1
  const auto page_of_tile = [](std::uint64_t i) { return kSigns | 3 << 6 | i; };
  const auto marked = [](std::uint8_t mark) { return Bytes(100, std::byte{mark}); };
  {
    PageWriter writer(folder / "a.talus");
    writer.put({kRecordTable, kTile}, marked(66));
    for (std::uint64_t i = 64; i-- > 0;) writer.put({0, page_of_tile(i)}, marked(static_cast<std::uint8_t>(100 + i)));
    writer.put({1, kTile}, marked(1));
    writer.put({kSliceTable, kTile}, marked(0));
    writer.finish();
  }
  const ReadTxn txn(PageStore::open(folder / "a.talus"));
  const std::byte* const first = txn.find({kSliceTable, kTile})->content.data();
  const auto place = [&](PageKey key) { return (txn.find(key)->content.data() - first) / 112; };
  EXPECT_EQ(place({1, kTile}), 1);
  // On the curve, bits of the column and of the row take turns, the column's first.
  const auto of_page = [&](unsigned x, unsigned y) {
    std::uint64_t at = 0;
    for (unsigned bit = 0; bit < 3; ++bit) at |= (x >> bit & 1u) << 2 * bit | (y >> bit & 1u) << (2 * bit + 1);
    return place({0, page_of_tile(at)});
  };
  for (unsigned k = 0; k < 8; ++k) {
    EXPECT_EQ(of_page(0, 7 - k), 2 + k);
    EXPECT_EQ(of_page(k, 0), 9 + k);
  }
  EXPECT_EQ(of_page(1, 1), 17);
  EXPECT_EQ(of_page(7, 7), 65);
  EXPECT_EQ(place({kRecordTable, kTile}), 66);
}

TEST(PageStore, DamageToATileIsCorruptOrElsewhere) {
  const TempFolder folder;
  Random random(13);
  Pages pages;
  for (const std::uint64_t i : {0, 3, 8, 10, 33, 63}) pages[{0, i}] = random_bytes(random, 400);
  write(folder / "a.talus", pages);
  const Bytes whole = read_file(folder / "a.talus");
  const Bytes& first = pages.begin()->second;
  const auto found = std::search(whole.begin(), whole.end(), first.begin(), first.end());
  ASSERT_NE(found, whole.end());
  const auto page_at = static_cast<std::size_t>(found - whole.begin());
  const std::size_t tile_at = page_at - kPagePrefixBytes - kTileDirectoryBytes - 2 * (400 + kPagePrefixBytes);
  for (std::size_t at = tile_at; at < page_at + 400; at += 5) {
    // Pages 10 and 8 stand before it, at 0/3 and 0/2; their own bytes do not matter to it.
    if (at >= tile_at + kTileDirectoryBytes && at < page_at - kPagePrefixBytes) continue;
    Bytes bytes = whole;
    bytes[at] ^= std::byte{0x40};
    const fs::path file = folder / ("b" + std::to_string(at));
    write_file(file, bytes);
    const ReadTxn txn(PageStore::open(file));
    EXPECT_EQ(cause_of([&] { static_cast<void>(txn.find({0, 0})); }), Cause::corrupt) << at - tile_at;
  }
}

// ---- the seal ----------------------------------------------------------------------------------------

TEST(Seal, AnyChangedByteOfTheFileIsNoticed) {
  const TempFolder folder;
  Random random(14);
  write(folder / "a.talus", random_pages(random, 40, 3000));
  EXPECT_EQ(check_seal(folder / "a.talus"), "");
  const Bytes whole = read_file(folder / "a.talus");
  for (std::size_t at = 0; at < whole.size(); at += 997) {
    Bytes bytes = whole;
    bytes[at] ^= std::byte{1};
    write_file(folder / "b.talus", bytes);
    EXPECT_NE(check_seal(folder / "b.talus"), "") << at;
  }
  for (const std::size_t size : {whole.size() - 1, whole.size() - 32, whole.size() / 2}) {
    write_file(folder / "b.talus", std::span(whole).first(size));
    EXPECT_NE(check_seal(folder / "b.talus"), "") << size;
  }
  Bytes longer = whole;
  longer.push_back(std::byte{0});
  write_file(folder / "b.talus", longer);
  EXPECT_NE(check_seal(folder / "b.talus"), "");
}

TEST(Seal, AFileThatIsWrittenAgainIsSealedAgain) {
  const TempFolder folder;
  write(folder / "a.talus", {{{1, 1}, Bytes(5000)}});
  {
    PageWriter writer(folder / "a.talus");
    EXPECT_NE(check_seal(folder / "a.talus"), "") << "while it is written";
    writer.put({1, 2}, Bytes(100));
    writer.finish();
  }
  EXPECT_EQ(check_seal(folder / "a.talus"), "");
  const ReadTxn txn(PageStore::open(folder / "a.talus"));
  EXPECT_TRUE(txn.find({1, 1}).has_value());
  EXPECT_TRUE(txn.find({1, 2}).has_value());
}

TEST(PageStore, AMissingFileIsNotFoundAndWhatIsNoDatabaseIsCorrupt) {
  const TempFolder folder;
  const auto open = [](const fs::path& file) { return cause_of([&] { static_cast<void>(PageStore::open(file)); }); };
  EXPECT_EQ(open(folder / "none"), Cause::not_found);
  EXPECT_EQ(open(folder.path()), Cause::corrupt);
  write_file(folder / "empty", {});
  EXPECT_EQ(open(folder / "empty"), Cause::corrupt);
  const std::string text(20000, 'x');
  write_file(folder / "text", std::as_bytes(std::span(text)));
  EXPECT_EQ(open(folder / "text"), Cause::corrupt);
}

/// A small tree with a branch page, large values and several tables.
Bytes whole_file(const TempFolder& folder) {
  Random random(8);
  Pages pages;
  for (std::uint64_t i = 0; i < 60; ++i) pages[{2, i}] = random_bytes(random, 300);
  for (std::uint64_t i = 0; i < 5; ++i) pages[{1, i}] = random_bytes(random, 9000);
  pages[{kHeaderTable, 0}] = random_bytes(random, 700);
  write(folder / "whole.talus", pages);
  return read_file(folder / "whole.talus");
}

/// Before version 3 a database had several tables in its file.
TEST(PageStore, AFileWithNamedTablesIsOfAnOlderVersion) {
  const TempFolder folder;
  const fs::path file = folder / "a.talus";
  write_older_database(file);
  try {
    static_cast<void>(PageStore::open(file));
    FAIL() << "it was opened";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::unsupported);
    EXPECT_NE(std::string(failure.what()).find("older version"), std::string::npos) << failure.what();
  }
}

TEST(Structure, EveryTruncationIsCorrupt) {
  const TempFolder folder;
  const Bytes bytes = whole_file(folder);
  for (std::size_t size = 0; size < bytes.size(); size += size < 300 ? 7 : 1777) {
    write_file(folder / "cut.talus", std::span(bytes).first(size));
    EXPECT_FALSE(check_structure(folder / "cut.talus").empty()) << size;
    EXPECT_EQ(cause_of([&] { static_cast<void>(PageStore::open(folder / "cut.talus")); }), Cause::corrupt) << size;
  }
  write_file(folder / "cut.talus", std::span(bytes).first(bytes.size() - 1));
  EXPECT_EQ(check_structure(folder / "cut.talus"), std::vector<std::string>{}) << "only the seal was cut";
  EXPECT_NE(check_seal(folder / "cut.talus"), "");
}

/// The file with a 16-, 32- or 64-bit number changed at a place of a page.
template <class Int>
Bytes changed(Bytes bytes, std::size_t page, std::size_t at, Int value) {
  std::memcpy(&bytes[page * 4096 + at], &value, sizeof value);
  return bytes;
}

TEST(Structure, ManglingATreePageIsFound) {
  const TempFolder folder;
  const Bytes bytes = whole_file(folder);
  const auto flags_of = [&](std::size_t page) {
    std::uint16_t flags = 0;
    std::memcpy(&flags, &bytes[page * 4096 + 10], sizeof flags);
    return flags;
  };
  const auto refused = [&](const Bytes& damaged) {
    write_file(folder / "b.talus", damaged);
    const bool found = !check_structure(folder / "b.talus").empty();
    if (found) {
      EXPECT_EQ(cause_of([&] { static_cast<void>(PageStore::open(folder / "b.talus")); }), Cause::corrupt);
    }
    return found;
  };
  int leaves = 0, branches = 0;
  for (std::size_t page = 2; page < bytes.size() / 4096; ++page) {
    const bool leaf = flags_of(page) == 2, branch = flags_of(page) == 1;
    if (!leaf && !branch) continue;
    std::uint64_t number = 0;
    std::memcpy(&number, &bytes[page * 4096], sizeof number);
    if (number != page) continue;  // inside a large value
    // Pages of older transactions are left over and free: what the tree does not reach, nobody minds.
    if (!refused(changed(bytes, page, 0, number + 1))) continue;
    (leaf ? leaves : branches) += 1;
    EXPECT_TRUE(refused(changed(bytes, page, 10, static_cast<std::uint16_t>(leaf ? 1 : 2)))) << "another kind of page";
    EXPECT_TRUE(refused(changed(bytes, page, 12, std::uint16_t{60000}))) << "filled beyond its end";
    EXPECT_TRUE(refused(changed(bytes, page, 14, std::uint16_t{5000}))) << "nodes from beyond its end";
    EXPECT_TRUE(refused(changed(bytes, page, 16, std::uint16_t{4094}))) << "a node that hangs out";
    EXPECT_TRUE(refused(changed(bytes, page, 16, std::uint16_t{0}))) << "a node in the header";
    EXPECT_TRUE(refused(changed(bytes, page, 12, std::uint16_t{16}))) << "no node at all";
    std::uint16_t node = 0;
    std::memcpy(&node, &bytes[page * 4096 + 16], sizeof node);
    EXPECT_TRUE(refused(changed(bytes, page, node + 6u, std::uint16_t{65000}))) << "a key beyond the page";
    if (branch) {
      EXPECT_TRUE(refused(changed(bytes, page, node, std::uint32_t{1}))) << "a pointer to a header";
      EXPECT_TRUE(refused(changed(bytes, page, node, std::uint32_t{1000000}))) << "a pointer beyond the file";
      EXPECT_TRUE(refused(changed(bytes, page, node, static_cast<std::uint32_t>(page)))) << "a pointer to itself";
      EXPECT_TRUE(refused(changed(bytes, page, 12, std::uint16_t{18}))) << "a branch with one arm";
      std::uint16_t second = 0;
      std::memcpy(&second, &bytes[page * 4096 + 18], sizeof second);
      std::uint32_t arm = 0;
      std::memcpy(&arm, &bytes[page * 4096 + node], sizeof arm);
      EXPECT_TRUE(refused(changed(bytes, page, second, arm))) << "two arms with one hand";
    } else {
      EXPECT_TRUE(refused(changed(bytes, page, node + 4u, std::uint16_t{4}))) << "a node with duplicates";
      EXPECT_TRUE(refused(changed(bytes, page, node + 4u, std::uint16_t{3}))) << "large and a table at once";
      EXPECT_TRUE(refused(changed(bytes, page, node, std::uint32_t{0xffffffff}))) << "a value beyond everything";
    }
  }
  EXPECT_GT(leaves, 3);
  EXPECT_GT(branches, 0);
}

TEST(Structure, DamagedHeadersAreFound) {
  const TempFolder folder;
  const Bytes bytes = whole_file(folder);
  const auto refused = [&](const Bytes& damaged) {
    write_file(folder / "b.talus", damaged);
    EXPECT_EQ(cause_of([&] { static_cast<void>(PageStore::open(folder / "b.talus")); }), Cause::corrupt);
    return !check_structure(folder / "b.talus").empty();
  };
  for (const std::size_t page : {0u, 1u}) {
    EXPECT_TRUE(refused(changed(bytes, page, 16, std::uint32_t{7}))) << "magic";
    EXPECT_TRUE(refused(changed(bytes, page, 20, std::uint32_t{9}))) << "version";
    EXPECT_TRUE(refused(changed(bytes, page, 40, std::uint32_t{100}))) << "page size";
    EXPECT_TRUE(refused(changed(bytes, page, 10, std::uint16_t{2}))) << "no header";
  }
}

TEST(PageWriter, WhatWasCommittedIsThereWhenItIsOpenedAgain) {
  const TempFolder folder;
  const Bytes page(100, std::byte{3});
  {
    PageWriter writer(folder / "a.talus");
    writer.put({0, 1}, page);
    writer.commit(true);
    writer.put({0, 70}, page);  // never committed
  }
  PageWriter writer(folder / "a.talus");
  const ReadTxn view = writer.view();
  EXPECT_EQ(copy(*view.find({0, 1})), page);
  EXPECT_FALSE(view.find({0, 70}).has_value());
}

/// A file whose pages replaced others of some size, in the header and in a table.
std::string file_after_replacing(const fs::path& file, std::size_t size, std::uint64_t seed) {
  Random random(seed);
  const auto kept = [](std::uint64_t i) { return Bytes(static_cast<std::size_t>(2 * i + 1), std::byte{5}); };
  {
    PageWriter writer(file);
    for (std::uint64_t i = 0; i < 40; ++i) writer.put({3, i}, random_bytes(random, size));
    writer.put({kHeaderTable, 1}, random_bytes(random, size));
    writer.commit(true);
    for (std::uint64_t i = 0; i < 40; ++i) writer.put({3, i}, i % 2 == 0 ? Bytes{} : kept(i));
    writer.put({kHeaderTable, 1}, {});
    writer.finish();
  }
  EXPECT_TRUE(check_structure(file).empty());
  const PageStore store = PageStore::open(file);
  EXPECT_EQ(copy(*ReadTxn(store).find({3, 39})), kept(39));
  EXPECT_EQ(copy(*ReadTxn(store).find({kHeaderTable, 1})), Bytes{});
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(PageWriter, LeavesNothingInTheFileOfWhatItReplaced) {
  for (const std::size_t size : {60u, 61u, 1500u, 1501u, 9000u}) {
    SCOPED_TRACE(size);
    const TempFolder folder;
    EXPECT_TRUE(file_after_replacing(folder / "a.talus", size, 1) == file_after_replacing(folder / "b.talus", size, 2));
  }
}

TEST(PageWriter, AViewShowsWhatWasPut) {
  const TempFolder folder;
  PageWriter writer(folder / "a.talus");
  const Bytes page(100, std::byte{3});
  writer.put({0, 1}, page);
  EXPECT_TRUE(writer.view().find({0, 1}).has_value());
  writer.put({4, 9}, page);
  EXPECT_TRUE(writer.view().find({4, 9}).has_value()) << "a table that was not there before";
}

TEST(PageWriter, LeavesNothingThatOpensIfItDoesNotFinish) {
  const TempFolder folder;
  {
    PageWriter writer(folder / "a.talus");
    writer.put({0, 1}, Bytes(100));
  }
  if (fs::exists(folder / "a.talus")) {
    EXPECT_FALSE(ReadTxn(PageStore::open(folder / "a.talus")).find({0, 1}).has_value());
  }
}

}  // namespace
}  // namespace talus::support
