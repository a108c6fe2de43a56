#pragma once
// The voids of a page, and which triangles around its vertices hold data.

#include <cstdint>
#include <span>

#include "engine/page/number_coder.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {

/// Numbers a contexts of these parts take, from a first one on.
inline constexpr int kVoidContexts = 17, kCoverContexts = 2;

/// `valid` row by row over the page's grid, 0 or 1: blocks of 8² as all data, all void or mixed, then the mixed ones
/// bit by bit.
void put_voids(const PageGrid& grid, std::span<const std::uint8_t> valid, int context, NumberWriter& out);
void get_voids(const PageGrid& grid, std::span<std::uint8_t> valid, int context, NumberReader& in);

/// Covers of own vertices, by the difference to what the page's own voids say: nothing unless data beyond the page
/// matters. `valid` empty: all data. Covers of other samples become 0.
///
/// put returns whether those of all vertices inside the page follow from the voids: then only the others are stored,
/// and get must be told. get returns false for a number no cover can be.
bool put_covers(PageId id, int bands, const PageGrid& grid, std::span<const std::uint8_t> valid,
                std::span<const std::uint8_t> covers, int context, NumberWriter& out);
[[nodiscard]] bool get_covers(PageId id, int bands, const PageGrid& grid, std::span<const std::uint8_t> valid,
                              bool inner_follow, std::span<std::uint8_t> covers, int context, NumberReader& in);

}  // namespace talus
