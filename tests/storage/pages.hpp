#pragma once
// What tests of files of pages share.

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "storage/page_store.hpp"
#include "talus/failure.hpp"
#include "tests/support/random.hpp"

namespace talus::support {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;
using Pages = std::map<PageKey, Bytes>;

inline Bytes random_bytes(Random& random, std::size_t size) {
  Bytes bytes(size);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random.next() & 0xff);
  return bytes;
}

inline Bytes copy(const StoredPage& page) { return {page.content.begin(), page.content.end()}; }

inline void write(const fs::path& file, const Pages& pages) {
  PageWriter writer(file);
  for (const auto& [key, bytes] : pages) writer.put(key, bytes);
  const std::uint64_t bytes = writer.finish();
  EXPECT_EQ(bytes, fs::file_size(file));
}

inline Pages random_pages(Random& random, int count, int most_bytes) {
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

inline void expect_holds(const ReadTxn& txn, const Pages& pages) {
  for (const auto& [key, bytes] : pages) {
    const auto found = txn.find(key);
    ASSERT_TRUE(found.has_value()) << "table " << key.table << ", position " << key.position;
    EXPECT_EQ(copy(*found), bytes);
  }
}

inline Cause cause_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Failure& failure) {
    EXPECT_STRNE(failure.what(), "");
    return failure.cause();
  }
  ADD_FAILURE() << "did not fail";
  return Cause{};
}

inline Bytes read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}
inline void write_file(const fs::path& file, std::span<const std::byte> bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace talus::support
