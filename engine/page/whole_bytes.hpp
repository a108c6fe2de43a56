#pragma once
// Whole numbers as bytes, little endian, and signed ones as unsigned ones.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace talus {

template <class Int>
void put(std::vector<std::byte>& out, Int value) {
  for (std::size_t i = 0; i < sizeof(Int); ++i) out.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
}
/// The number in `size` bytes from `at` on; the caller knows that they are there.
[[nodiscard]] inline std::uint64_t whole_at(std::span<const std::byte> bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
  return value;
}

/// 0, -1, 1, -2 … as 0, 1, 2, 3 …
[[nodiscard]] constexpr std::uint64_t zigzag(std::int64_t v) {
  return static_cast<std::uint64_t>(v) << 1 ^ static_cast<std::uint64_t>(v >> 63);
}
[[nodiscard]] constexpr std::int64_t unzigzag(std::uint64_t v) {
  return static_cast<std::int64_t>(v >> 1 ^ (0 - (v & 1)));
}

}  // namespace talus
