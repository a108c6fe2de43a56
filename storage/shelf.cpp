#include "storage/shelf.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "storage/checksum.hpp"
#include "storage/environment.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr std::size_t kDirectoryBytes = 4 * kShelfPages;

void put_big_endian(std::uint64_t value, std::byte* to) {
  for (std::size_t i = 0; i < 8; ++i) to[i] = static_cast<std::byte>(value >> (56 - 8 * i) & 0xff);
}
void put_little_endian(std::uint32_t value, std::byte* to) {
  for (std::size_t i = 0; i < 4; ++i) to[i] = static_cast<std::byte>(value >> (8 * i) & 0xff);
}
std::uint32_t get_little_endian(const std::byte* from) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | std::to_integer<std::uint32_t>(from[i]);
  return value;
}

/// A key that no page has, so that a directory's checksum never fits a page.
PageKey directory_key(int table, std::uint64_t shelf) { return {table, ~shelf}; }

Failure corrupt(PageKey key, const char* what) {
  return {Cause::corrupt, fmt::format("corrupt: page {:#x} of {}: {}", key.position, table_name(key.table), what)};
}

}  // namespace

KeyBytes key_bytes(std::uint64_t position) {
  KeyBytes bytes{};
  for (std::size_t i = 0; i < 8; ++i) bytes[i] = static_cast<std::uint8_t>(position >> (56 - 8 * i));
  return bytes;
}

std::uint64_t position_of(const void* key) {
  const auto* bytes = static_cast<const std::uint8_t*>(key);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = value << 8 | bytes[i];
  return value;
}

std::vector<std::byte> wrapped(PageKey key, std::uint32_t generation, std::span<const std::byte> content) {
  std::vector<std::byte> stored(kPagePrefixBytes + content.size());
  put_big_endian(page_checksum(key, generation, content), stored.data());
  put_little_endian(generation, stored.data() + kChecksumBytes);
  std::copy(content.begin(), content.end(), stored.begin() + kPagePrefixBytes);
  return stored;
}

StoredPage unwrapped(PageKey key, std::span<const std::byte> stored) {
  if (stored.size() < kPagePrefixBytes) throw corrupt(key, "it is shorter than its checksum");
  const StoredPage page{stored.subspan(kPagePrefixBytes), get_little_endian(stored.data() + kChecksumBytes)};
  if (position_of(stored.data()) != page_checksum(key, page.generation, page.content))
    throw corrupt(key, "its checksum is wrong");
  return page;
}

std::size_t shelf_size(const ShelfPages& pages) {
  std::size_t bytes = kChecksumBytes + kDirectoryBytes;
  for (const auto& page : pages) bytes += page.size();
  return bytes;
}

void lay_shelf(int table, std::uint64_t shelf, const ShelfPages& pages, std::byte* to) {
  std::byte *const directory = to + kChecksumBytes, *at = directory + kDirectoryBytes;
  for (std::size_t i = 0; i < kShelfPages; ++i) {
    put_little_endian(static_cast<std::uint32_t>(pages[i].size()), directory + 4 * i);
    at = std::copy(pages[i].begin(), pages[i].end(), at);
  }
  put_big_endian(page_checksum(directory_key(table, shelf), 0, {directory, kDirectoryBytes}), to);
}

std::array<std::span<const std::byte>, kShelfPages> pages_of_shelf(int table, std::uint64_t shelf,
                                                                   std::span<const std::byte> value) {
  const PageKey first{table, shelf << kShelfShift};
  if (value.size() < kChecksumBytes + kDirectoryBytes)
    throw corrupt(first, "its group of 64 pages is shorter than the directory");
  const auto directory = value.subspan(kChecksumBytes, kDirectoryBytes);
  if (position_of(value.data()) != page_checksum(directory_key(table, shelf), 0, directory))
    throw corrupt(first, "the checksum of its group of 64 pages is wrong");
  std::array<std::span<const std::byte>, kShelfPages> pages;
  std::size_t at = kChecksumBytes + kDirectoryBytes;
  for (std::size_t i = 0; i < kShelfPages; ++i) {
    const std::size_t bytes = get_little_endian(&directory[4 * i]);
    if (bytes > value.size() - at) throw corrupt(first, "its group of 64 pages is shorter than its pages");
    pages[i] = value.subspan(at, bytes);
    at += bytes;
  }
  return pages;
}

}  // namespace talus
