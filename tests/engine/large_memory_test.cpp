// Memory for large arrays: as much as was asked for, aligned, kept apart and given back.

#include "engine/machine/large_memory.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <new>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "talus/array.hpp"

namespace talus::support {
namespace {

constexpr std::size_t kMegabyte = std::size_t{1} << 20, kHugePage = 2 * kMegabyte;

/// Around the sizes where another way of getting memory begins.
constexpr std::size_t kSizes[] = {0,
                                  1,
                                  4095,
                                  kMegabyte - 1,
                                  kMegabyte,
                                  kMegabyte + 1,
                                  kHugePage,
                                  kHugePage + 1,
                                  2 * kHugePage - 1,
                                  2 * kHugePage,
                                  5 * kMegabyte + 7};

bool is_aligned(const void* memory, std::size_t to) { return reinterpret_cast<std::uintptr_t>(memory) % to == 0; }

TEST(LargeMemory, FreshPagesAreZeroAlignedAndAllThere) {
  auto* memory = static_cast<unsigned char*>(map_large_pages(3 * kHugePage));
  ASSERT_NE(memory, nullptr);
  EXPECT_TRUE(is_aligned(memory, kHugePage));
  for (std::size_t i = 0; i < 3 * kHugePage; i += 509) {
    EXPECT_EQ(memory[i], 0);
    memory[i] = 7;
  }
  memory[3 * kHugePage - 1] = 7;
  unmap_large_pages(memory, 3 * kHugePage);
}

TEST(LargeMemory, TheWishForLargePagesChangesNothing) {
  std::vector<unsigned char> bytes(3 * kHugePage, 5);
  for (const std::size_t size : kSizes) {
    if (size <= bytes.size() - 3) ask_for_large_pages(bytes.data() + 3, size);
  }
  for (std::size_t i = 0; i < bytes.size(); i += 101) ASSERT_EQ(bytes[i], 5);
}

TEST(LargeMemory, PiecesOfAnySizeAreKeptApart) {
  LargePages pages;
  std::vector<std::pair<unsigned char*, std::size_t>> pieces;
  for (const std::size_t size : kSizes) {
    auto* piece = static_cast<unsigned char*>(pages.allocate(size));
    for (std::size_t i = 0; i < size; ++i) piece[i] = static_cast<unsigned char>(size % 251);
    pieces.emplace_back(piece, size);
  }
  for (const auto& [piece, size] : pieces) {
    for (std::size_t i = 0; i < size; i += 97) ASSERT_EQ(piece[i], size % 251);
    if (size >= kMegabyte) {
      EXPECT_TRUE(is_aligned(piece, kHugePage));
    }
    pages.deallocate(piece, size);
  }
  LargePages others;
  EXPECT_TRUE(pages.is_equal(pages));
  EXPECT_FALSE(pages.is_equal(others));
}

TEST(LargeMemory, AVectorOfItGrowsAndKeepsItsValues) {
  std::vector<std::uint32_t, LargeAllocator<std::uint32_t>> values;
  for (std::uint32_t i = 0; i < 3'000'000; ++i) values.push_back(i);
  for (std::uint32_t i = 0; i < 3'000'000; i += 1001) ASSERT_EQ(values[i], i);
  values.reserve(4 * kHugePage / sizeof(std::uint32_t));
  EXPECT_TRUE(is_aligned(values.data(), kHugePage));
}

TEST(LargeMemory, RoomIsMadeOnceAndSomeMore) {
  std::vector<double, LargeAllocator<double>> values;
  make_room(values, 1000);
  EXPECT_GE(values.capacity(), 1250u);
  const double* before = values.data();
  make_room(values, 1250);
  make_room(values, 3);
  EXPECT_EQ(values.data(), before);
  make_room(values, values.capacity() + 1);
  EXPECT_TRUE(values.empty());
  EXPECT_GT(values.capacity(), 1250u);
}

TEST(LargeMemory, ArraysKeepTheirValuesAndLeaveNewOnesAsTheyAre) {
  Array<std::uint64_t> array;
  for (std::uint64_t i = 0; i < 400'000; ++i) array.push_back(i);  // beyond a megabyte, where other memory begins
  for (std::uint64_t i = 0; i < 400'000; i += 777) ASSERT_EQ(array[i], i);
  Array<std::uint64_t> other = array;
  other.resize(10);
  other.resize(400'000);  // in the memory that it has
  EXPECT_EQ(other[399'999], 399'999u) << "resize wrote over what was there";
  other.assign(400'000, 3);
  EXPECT_EQ(other[399'999], 3u);
}

TEST(LargeMemory, MoreThanThereCanBeIsRefused) {
  EXPECT_THROW(static_cast<void>(detail::allocate_large(std::numeric_limits<std::size_t>::max())), std::bad_alloc);
  EXPECT_THROW(static_cast<void>(detail::allocate_large(std::numeric_limits<std::size_t>::max() / 2)), std::bad_alloc);
  ArrayAllocator<double> allocator;
  EXPECT_THROW(static_cast<void>(allocator.allocate(std::numeric_limits<std::size_t>::max() / 4)), std::bad_alloc);
  // So many that their bytes, counted in 64 bits, would be few.
  EXPECT_THROW(static_cast<void>(allocator.allocate((std::size_t{1} << 61) + 1)), std::bad_alloc);
}

}  // namespace
}  // namespace talus::support
