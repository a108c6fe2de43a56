#pragma once
// The numbers of a page's square at multiples of 8: what DenseNumbers expects to be known.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/page/page_layout.hpp"

namespace talus {

inline constexpr int kCornersAcross = kPageSide / kChildrenAcross;

/// Appends them row by row: the bits of the row's largest difference (1 byte), then sixteen differences from the number
/// west of each, or north of the first one, zigzag, lowest bits first. T: std::uint16_t, std::uint32_t or
/// std::uint64_t; arithmetic wraps around.
template <class T>
void put_corner_numbers(std::span<const T> square, std::vector<std::byte>& out);

/// A check of them, for readers that have them from elsewhere.
template <class T>
[[nodiscard]] std::uint32_t check_of_corner_numbers(std::span<const T> square);

/// Reads them from the beginning of `bytes`.
/// returns  the bytes that were read; 0: no such bytes
template <class T>
[[nodiscard]] std::size_t get_corner_numbers(std::span<const std::byte> bytes, std::span<T> square);

}  // namespace talus
