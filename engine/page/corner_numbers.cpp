#include "engine/page/corner_numbers.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "engine/page/digest.hpp"

namespace talus {
namespace {

constexpr std::size_t kAcross = kCornersAcross;

constexpr std::size_t place_of(std::size_t col, std::size_t row) { return (row * kPageSide + col) * kChildrenAcross; }

template <class T>
constexpr int kBits = std::numeric_limits<T>::digits;

template <class T>
T zigzag(T v) {
  return static_cast<T>(static_cast<T>(v << 1) ^ static_cast<T>(0 - (v >> (kBits<T> - 1))));
}
template <class T>
T unzigzag(T v) {
  return static_cast<T>(static_cast<T>(v >> 1) ^ static_cast<T>(0 - (v & 1)));
}

/// `bits` bits of a row's differences from bit `at` on; at most 57.
std::uint64_t bits_at(const std::array<std::uint8_t, 2 * 64 + 8>& row, std::size_t at, int bits) {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < 8; ++i) word |= std::uint64_t{row[at / 8 + i]} << (8 * i);
  return word >> (at % 8) & ((std::uint64_t{1} << bits) - 1);
}

}  // namespace

template <class T>
void put_corner_numbers(std::span<const T> square, std::vector<std::byte>& out) {
  T first = 0;
  for (std::size_t row = 0; row < kAcross; ++row) {
    std::array<T, kAcross> differences;
    T before = first, all = 0;
    for (std::size_t col = 0; col < kAcross; ++col) {
      const T number = square[place_of(col, row)];
      differences[col] = zigzag(static_cast<T>(number - before));
      all = static_cast<T>(all | differences[col]);
      before = number;
      if (col == 0) first = number;
    }
    const auto bits = static_cast<int>(std::bit_width(all));
    out.push_back(static_cast<std::byte>(bits));
    const std::size_t from = out.size();
    out.resize(from + 2 * static_cast<std::size_t>(bits));
    std::size_t at = 0;
    for (const T difference : differences) {
      for (int bit = 0; bit < bits; ++bit, ++at)
        out[from + at / 8] |= static_cast<std::byte>((difference >> bit & 1) << (at % 8));
    }
  }
}

template <class T>
std::size_t get_corner_numbers(std::span<const std::byte> bytes, std::span<T> square) {
  std::size_t read = 0;
  T first = 0;
  for (std::size_t row = 0; row < kAcross; ++row) {
    if (read == bytes.size()) return 0;
    const int bits = std::to_integer<int>(bytes[read++]);
    const std::size_t size = 2 * static_cast<std::size_t>(bits);
    if (bits > kBits<T> || size > bytes.size() - read) return 0;
    std::array<std::uint8_t, 2 * 64 + 8> packed{};
    std::transform(&bytes[0] + read, &bytes[0] + read + size, packed.begin(),
                   [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
    read += size;
    T before = first;
    for (std::size_t col = 0; col < kAcross; ++col) {
      const std::size_t at = col * static_cast<std::size_t>(bits);
      const int low = std::min(bits, 32);
      std::uint64_t difference = bits_at(packed, at, low);
      if (bits > low) difference |= bits_at(packed, at + 32, bits - low) << 32;
      before = static_cast<T>(before + unzigzag(static_cast<T>(difference)));
      if (col == 0) first = before;
      square[place_of(col, row)] = before;
    }
  }
  return read;
}

template <class T>
std::uint32_t check_of_corner_numbers(std::span<const T> square) {
  std::array<std::uint8_t, kAcross * kAcross * sizeof(T)> bytes;  // little endian
  std::size_t at = 0;
  for (std::size_t row = 0; row < kAcross; ++row) {
    for (std::size_t col = 0; col < kAcross; ++col) {
      for (std::size_t i = 0; i < sizeof(T); ++i)
        bytes[at++] = static_cast<std::uint8_t>(square[place_of(col, row)] >> (8 * i));
    }
  }
  return static_cast<std::uint32_t>(digest_of(std::as_bytes(std::span(bytes))));
}

template std::uint32_t check_of_corner_numbers(std::span<const std::uint16_t>);
template std::uint32_t check_of_corner_numbers(std::span<const std::uint32_t>);
template std::uint32_t check_of_corner_numbers(std::span<const std::uint64_t>);
template void put_corner_numbers(std::span<const std::uint16_t>, std::vector<std::byte>&);
template void put_corner_numbers(std::span<const std::uint32_t>, std::vector<std::byte>&);
template void put_corner_numbers(std::span<const std::uint64_t>, std::vector<std::byte>&);
template std::size_t get_corner_numbers(std::span<const std::byte>, std::span<std::uint16_t>);
template std::size_t get_corner_numbers(std::span<const std::byte>, std::span<std::uint32_t>);
template std::size_t get_corner_numbers(std::span<const std::byte>, std::span<std::uint64_t>);

}  // namespace talus
