#pragma once
// Stage one of ingest: everything that follows for one tile from the samples in and around it.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/error/vertex_error.hpp"
#include "engine/error/voids.hpp"
#include "engine/page/tile_layout.hpp"

namespace talus {

/// Cells around a tile that its results depend on. The descendants of its vertices and their diamonds lie within one
/// block of it: a centre of spacing 32, 32 cells inside, reaches 96 cells; a side midpoint on the tile's side, 64.
/// Their fills reach kFillReach farther.
inline constexpr std::int32_t kHalo = kBlockSide + kFillReach;

/// The tile with the first row and column of the next tiles: each half-diamond of spacing 64 … 512 lies in exactly one.
[[nodiscard]] constexpr GridRect closed_tile(TileId id) {
  return {{id.x * kTileSide, id.y * kTileSide}, {(id.x + 1) * kTileSide, (id.y + 1) * kTileSide}};
}

/// The samples that a tile is computed from: its square and the halo, cut at the extent; may be empty. Every tile with
/// samples in its window must be computed, even without own samples: its vertices can join two vertices of the extent.
[[nodiscard]] GridRect tile_window(TileId id, GridRect extent);

/// The tiles of an extent. Their squares hold a sample, or lie within a block of one: vertices beyond the extent pass
/// errors on.
[[nodiscard]] constexpr GridRect tiles_of(GridRect extent) {
  return {{(extent.first.col - kBlockSide) >> kTileShift, (extent.first.row - kBlockSide) >> kTileShift},
          {(extent.last.col + kBlockSide) >> kTileShift, (extent.last.row + kBlockSide) >> kTileShift}};
}

struct TileInput {
  TileId id;
  GridRect extent;                      ///< extent of the database
  CodeSpan heights;                     ///< over tile_window(), row by row; unspecified where void
  std::span<const std::uint8_t> valid;  ///< 1: valid, 0: void; empty: all are valid
  CodeDistance distance;
  GroundSide ground_side;  ///< used with voids only
  double void_weight = 1;
  ErrorRule rule = {};
};

/// What the coarser levels need of a tile: a few kB that depend on the tile's window only.
struct TileRecord {
  /// One of the 16 × 16 blocks of kBlockSide cells.
  struct Block {
    ErrorCode error = 0;     ///< saturated error of its centre (spacing 32)
    std::uint8_t holds = 0;  ///< of the centre's halves: side 0 | side 1 << 2; outside the extent: kNothing
    bool has_data = false;  ///< one of its own kBlockSide² samples (north and west sides included) is valid; if not, it
                            ///< has no plane and no typical height
    /// Each own valid code lies between plane - below and plane + above, with the plane
    /// middle + right·(col − centre col) + down·(row − centre row); the rounding of this formula is included.
    float middle = 0, right = 0, down = 0, above = 0, below = 0;
    /// Bits of all (kBlockSide + 1)² samples and fills of the closed block, for the rounding margin.
    BitRange bits;
    double typical = 0;  ///< code of the valid own sample nearest to the middle of their range
  };
  std::array<Block, kTileBlocks * kTileBlocks> blocks{};

  static constexpr std::int32_t kAcross = kTileBlocks + 1;
  /// The 17 × 17 vertices on every 64th sample of the closed tile, row by row: the error before saturation, over the
  /// halves in this tile. 0 for vertices of spacing 1024 or more.
  std::array<ErrorCode, kAcross * kAcross> errors{};
  /// What the halves in this tile and in the extent hold, side 0 | side 1 << 2; and these flags.
  std::array<std::uint8_t, kAcross * kAcross> holds{};
  /// The half of this side has data and a corner with kNoFill. Its error above is only the least error of a mixed
  /// triangle.
  static constexpr std::uint8_t kOpenHalf[2] = {1 << 4, 1 << 5};
  /// The vertex is void without a valid sample within kFillReach: the coarse levels choose its height.
  static constexpr std::uint8_t kNoFill = 1 << 6;
};

struct TileErrors {
  /// All samples of the window are void. Then everything else is empty, heights too.
  bool all_void = false;
  /// Saturated errors of the levels of spacing below kBlockSide. They are right for vertices of the tile's own square,
  /// also outside the extent. Use holds(): the grid ends a few spacings outside, where errors are zero.
  LevelGrid<ErrorCode> errors{GridRect{{0, 0}, {-1, -1}}, kTileLevels, 0};
  std::optional<VoidMap> voids;  ///< over the window, same levels; empty: the window has no voids
  Codes heights;                 ///< over the window, with fills
  TileRecord record;
};

/// cost    linear; memory about 12 bytes a sample of the window
[[nodiscard]] TileErrors tile_errors(const TileInput& input);
/// The same, reusing the memory of another tile's result.
void tile_errors(const TileInput& input, TileErrors& result);

}  // namespace talus
