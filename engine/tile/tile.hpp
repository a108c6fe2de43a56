#pragma once
// Stage one of ingest: all that can be known of one tile from the samples in and around it.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/error/vertex_error.hpp"
#include "engine/error/voids.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {

/// A tile is the square of a page of band 1. Vertices of bands 0 and 1, spacing below kBlockSide, are settled in it.
inline constexpr int kTileShift = kPageShift + kBandLevels;
inline constexpr std::int32_t kTileSide = std::int32_t{1} << kTileShift;
inline constexpr std::int32_t kTileBlocks = kTileSide / kBlockSide;  ///< along a side: 16
/// Levels settled in a tile: spacings 1 … 32.
inline constexpr int kTileLevels = kBlockShift;
/// Cells around a tile that its results depend on. The descendants of its vertices, and their diamonds, lie within a
/// block's side of it (a centre of spacing 32 stands 32 cells inside and reaches 96 out; a side midpoint on the tile's
/// own side reaches 64); the fills they use come from kFillReach more.
inline constexpr std::int32_t kHalo = kBlockSide + kFillReach;

struct TileId {
  std::int32_t x = 0, y = 0;  ///< in tile sides, signed
  friend constexpr bool operator==(TileId, TileId) = default;
};

/// The tile with the samples of the next ones' first row and column: every half-diamond of spacing 64 … 512
/// lies in exactly one.
[[nodiscard]] constexpr GridRect closed_tile(TileId id) {
  return {{id.x * kTileSide, id.y * kTileSide}, {(id.x + 1) * kTileSide, (id.y + 1) * kTileSide}};
}

/// The samples a tile is computed from: its square and the halo, cut to the extent. May be empty. Every tile whose
/// window is not must be computed, those too that hold no sample of their own: vertices in them can join two
/// vertices of the extent.
[[nodiscard]] GridRect tile_window(TileId id, GridRect extent);

struct TileInput {
  TileId id;
  GridRect extent;                      ///< of all data
  CodeSpan heights;                     ///< over tile_window(), row by row, unspecified where void
  std::span<const std::uint8_t> valid;  ///< 1 where a sample is data; empty: all are
  CodeDistance distance;
  GroundSide ground_side;  ///< used with voids only
  double void_weight = 1;
  ErrorRule rule = {};
};

/// What the coarser levels must know of a tile. A few kB; everything in it depends on the tile's window only.
struct TileRecord {
  /// One of the 16×16 blocks of kBlockSide cells.
  struct Block {
    ErrorCode error = 0;     ///< saturated, of its centre (spacing 32)
    std::uint8_t holds = 0;  ///< of the centre's halves: side 0 | side 1 << 2; one that leaves the extent: kNothing
    bool has_data = false;   ///< any valid sample among its own kBlockSide² (north and west sides included); if not,
                             ///< no plane and no typical height
    /// Every own valid sample's code lies between plane - below and plane + above, where the plane is
    /// middle + right·(col − centre col) + down·(row − centre row); the rounding of evaluating that in double is
    /// included.
    float middle = 0, right = 0, down = 0, above = 0, below = 0;
    /// Of the closed block, all (kBlockSide + 1)² samples and their fills, as the margin's rule has it.
    BitRange bits;
    double typical = 0;  ///< code of the valid own sample nearest to the middle of their range
  };
  std::array<Block, kTileBlocks * kTileBlocks> blocks{};

  static constexpr std::int32_t kAcross = kTileBlocks + 1;
  /// Of the 17×17 vertices of every 64th sample on the closed tile, row by row: the raw (unsaturated) error and the
  /// holds of those halves that lie in this tile. Vertices of spacing 1024 and more have none: 0.
  std::array<ErrorCode, kAcross * kAcross> errors{};
  /// Side 0 | side 1 << 2, of halves in this tile and in the extent; and these flags.
  std::array<std::uint8_t, kAcross * kAcross> holds{};
  /// A half of this side has data and a corner whose fill is not known here: kNoFill. Its error above is the mixed
  /// triangle's least, without any distance.
  static constexpr std::uint8_t kOpenHalf[2] = {1 << 4, 1 << 5};
  /// The vertex is void and has no valid sample within kFillReach: the coarser levels give it a height.
  static constexpr std::uint8_t kNoFill = 1 << 6;
};

struct TileErrors {
  /// No sample of the window is data: everything else is empty, heights too.
  bool all_void = false;
  /// Saturated, of the levels of spacing below kBlockSide; right for vertices of the tile's own square, those
  /// outside the extent included (use holds(): it ends a few spacings outside, beyond are none but zeros).
  LevelGrid<ErrorCode> errors{GridRect{{0, 0}, {-1, -1}}, kTileLevels, 0};
  std::optional<VoidMap> voids;  ///< over the window, same levels; none where the window is all data
  Codes heights;                 ///< over the window, fills in place
  TileRecord record;
};

/// cost    linear; memory about 12 bytes a sample of the window
[[nodiscard]] TileErrors tile_errors(const TileInput& input);
/// The same into the memory of another tile's.
void tile_errors(const TileInput& input, TileErrors& result);

}  // namespace talus
