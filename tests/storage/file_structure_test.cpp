// The file as a whole: its seal, its trees, and files that are no database.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "storage/page_store.hpp"
#include "talus/failure.hpp"
#include "tests/storage/pages.hpp"
#include "tests/support/older_database.hpp"
#include "tests/support/random.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {
namespace {

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

}  // namespace
}  // namespace talus::support
