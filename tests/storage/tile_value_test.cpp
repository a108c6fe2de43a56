// All that a tile has as one value of the file: whose it is, in which order, and damage to it.

#include "storage/tile_value.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "engine/page/page_layout.hpp"
#include "storage/checksum.hpp"
#include "storage/page_store.hpp"
#include "tests/storage/pages.hpp"
#include "tests/support/random.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {
namespace {

TEST(TileValue, ATileIsReplacedAsAWhole) {
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

/// Whatever order its parts are put in, a tile has them in one order: the slice and the page of band 1 first, then the
/// pages along its west side, those along its north side, the others, and the record.
/// A page of band 0 belongs to the tile of the page above it, wherever that is.
TEST(TileValue, ATileHasThePagesBelowItsPageOfBand1) {
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

TEST(TileValue, ATileHasItsPartsInTheOrderInWhichTheyAreRead) {
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

TEST(TileValue, DamageToATileIsCorruptOrElsewhere) {
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

}  // namespace
}  // namespace talus::support
