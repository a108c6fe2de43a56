#pragma once
// A tile is the square of a page of band 1: 64 pages of band 0, and that page above them.

#include <cstdint>

#include "engine/error/block_bits.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {

inline constexpr int kTileShift = kPageShift + kBandLevels;
inline constexpr std::int32_t kTileSide = std::int32_t{1} << kTileShift;
inline constexpr std::int32_t kTileBlocks = kTileSide / kBlockSide;  ///< along a side: 16
/// Levels that a tile has: spacings 1 … 32, all below kBlockSide.
inline constexpr int kTileLevels = kBlockShift;

struct TileId {
  std::int32_t x = 0, y = 0;  ///< in tile sides, signed
  friend constexpr bool operator==(TileId, TileId) = default;
};

/// The tile of a page of band 0 or 1.
[[nodiscard]] constexpr TileId tile_with(PageId id) {
  return id.band == 1 ? TileId{id.x, id.y} : TileId{id.x >> kBandLevels, id.y >> kBandLevels};
}

}  // namespace talus
