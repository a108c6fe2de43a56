#pragma once
// The voids of a page and the covers of its vertices.

#include <cstdint>
#include <span>

#include "engine/page/number_coder.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {

/// Number of contexts of each part.
inline constexpr int kVoidContexts = 17, kCoverContexts = 2;

/// `valid` is 0 or 1, row by row over the page's grid. Blocks of 8² are all valid, all void or mixed; mixed ones follow
/// bit by bit.
void put_voids(const PageGrid& grid, std::span<const std::uint8_t> valid, int context, NumberWriter& out);
void get_voids(const PageGrid& grid, std::span<std::uint8_t> valid, int context, NumberReader& in);

/// Covers of own vertices, as differences from what the page's voids imply: nothing unless data outside the page
/// matters. A square of samples that are all data implies 15, one that is all void 0. `valid` empty: all valid. Covers
/// of other samples become 0.
///
/// put returns whether the covers of all inner vertices follow from the voids: then only the others are stored, and get
/// must know it. get returns false if a number cannot be a cover.
bool put_covers(PageId id, int bands, const PageGrid& grid, std::span<const std::uint8_t> valid,
                std::span<const std::uint8_t> covers, int context, NumberWriter& out);
[[nodiscard]] bool get_covers(PageId id, int bands, const PageGrid& grid, std::span<const std::uint8_t> valid,
                              bool inner_follow, std::span<std::uint8_t> covers, int context, NumberReader& in);

}  // namespace talus
