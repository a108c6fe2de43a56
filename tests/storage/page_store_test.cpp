// Pages in a file: what went in comes out, in order, and damage is noticed.

#include "storage/page_store.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "storage/checksum.hpp"
#include "storage/tile_value.hpp"
#include "talus/failure.hpp"
#include "tests/storage/pages.hpp"
#include "tests/support/random.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {
namespace {

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