#include "storage/tile_value.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "storage/checksum.hpp"
#include "storage/environment.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr std::size_t kDirectoryBytes = 4 * kTileParts;
constexpr std::size_t kSlice = 0, kPageOfBand1 = 1, kPagesFrom = 2, kRecord = kTileParts - 1;

/// The part of each page of band 0, by its position in the tile.
struct Order {
  std::array<std::uint8_t, kTilePages> part{};
  constexpr Order() {
    std::size_t next = 0;
    std::array<bool, kTilePages> placed{};
    const auto place = [&](unsigned x, unsigned y) {
      std::size_t at = 0;  // on the curve
      for (unsigned bit = 0; bit < 3; ++bit) at |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
      if (placed[at]) return;
      placed[at] = true;
      part[at] = static_cast<std::uint8_t>(kPagesFrom + next++);
    };
    for (unsigned y = 8; y-- > 0;) place(0, y);
    for (unsigned x = 1; x < 8; ++x) place(x, 0);
    for (unsigned y = 1; y < 8; ++y) {
      for (unsigned x = 1; x < 8; ++x) place(x, y);
    }
  }
};
constexpr Order kOrder;

void put_big_endian(std::uint64_t value, std::byte* to) {
  for (std::size_t i = 0; i < 8; ++i) to[i] = static_cast<std::byte>(value >> (56 - 8 * i) & 0xff);
}
std::uint64_t get_big_endian(const std::byte* from) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = value << 8 | std::to_integer<std::uint64_t>(from[i]);
  return value;
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
PageKey directory_key(std::uint64_t tile) { return {kTileTable, ~tile}; }

Failure corrupt(PageKey key, const char* what) {
  return {Cause::corrupt, fmt::format("corrupt: page {:#x} of {}: {}", key.position, table_name(key.table), what)};
}

}  // namespace

KeyBytes key_bytes(PageKey value) {
  KeyBytes bytes{static_cast<std::uint8_t>(value.table - kHeaderTable)};
  for (std::size_t i = 0; i < 8; ++i) bytes[1 + i] = static_cast<std::uint8_t>(value.position >> (56 - 8 * i));
  return bytes;
}

std::optional<PageKey> key_from(std::span<const std::byte> bytes) {
  if (bytes.size() != sizeof(KeyBytes)) return std::nullopt;
  const PageKey key{std::to_integer<int>(bytes[0]) + kHeaderTable, get_big_endian(bytes.data() + 1)};
  if (key.table > kLastBandTable || (is_of_tile(key.table) && key.table != kTileTable)) return std::nullopt;
  return key;
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
  if (get_big_endian(stored.data()) != page_checksum(key, page.generation, page.content))
    throw corrupt(key, "its checksum is wrong");
  return page;
}

std::size_t part_of(PageKey key) {
  if (key.table == 0) return kOrder.part[key.position % kTilePages];
  return key.table == 1 ? kPageOfBand1 : key.table == kSliceTable ? kSlice : kRecord;
}

std::size_t tile_size(const TileParts& parts) {
  std::size_t bytes = kTileDirectoryBytes;
  for (const auto& part : parts) bytes += part.size();
  return bytes;
}

void lay_tile(std::uint64_t tile, const TileParts& parts, std::byte* to) {
  std::byte *const directory = to + kChecksumBytes, *at = directory + kDirectoryBytes;
  for (std::size_t i = 0; i < kTileParts; ++i) {
    put_little_endian(static_cast<std::uint32_t>(parts[i].size()), directory + 4 * i);
    at = std::copy(parts[i].begin(), parts[i].end(), at);
  }
  put_big_endian(page_checksum(directory_key(tile), 0, {directory, kDirectoryBytes}), to);
}

std::array<std::span<const std::byte>, kTileParts> parts_of_tile(std::uint64_t tile, std::span<const std::byte> value) {
  const auto corrupt_tile = [&](const char* what) {
    return Failure(Cause::corrupt, fmt::format("corrupt: tile {:#x}: {}", tile, what));
  };
  if (value.size() < kTileDirectoryBytes) throw corrupt_tile("it is shorter than its directory");
  const auto directory = value.subspan(kChecksumBytes, kDirectoryBytes);
  if (get_big_endian(value.data()) != page_checksum(directory_key(tile), 0, directory))
    throw corrupt_tile("the checksum of its directory is wrong");
  std::array<std::span<const std::byte>, kTileParts> parts;
  std::size_t at = kTileDirectoryBytes;
  for (std::size_t i = 0; i < kTileParts; ++i) {
    const std::size_t bytes = get_little_endian(&directory[4 * i]);
    if (bytes > value.size() - at) throw corrupt_tile("it is shorter than its parts");
    parts[i] = value.subspan(at, bytes);
    at += bytes;
  }
  return parts;
}

}  // namespace talus
