#pragma once
// The slice of a tile: its few vertices with the largest errors. In most databases it is a copy, so that a coarse
// question need not read all pages of the tile for them; in one that keeps the vertices of a tolerance it may be all that
// the tile has.
//
// Saturated errors are closed under parents, so the vertices above any threshold form a restricted quadtree. A slice
// has one bit for each grid point whose parents are in it, and the heights and errors of the vertices as numbers.
// docs/format/v3.md has the bytes.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/page/number_coder.hpp"
#include "engine/page/page.hpp"
#include "engine/page/tile_layout.hpp"

namespace talus {

/// A threshold of a slice that holds nothing.
inline constexpr std::int32_t kNoSlice = kMostEighths;

/// A tile's vertices of spacing 1 to 32 with an error above a threshold, and some that the sides of the extent need, in any
/// order. All vectors have the same length. Errors are what they count as, see Page::counted_error.
struct TileSlice {
  std::int32_t above = 0;             ///< the threshold, at least 0; kNoSlice
  bool is_all = false;                ///< for encode(): no vertex may be left out
  std::vector<std::uint32_t> places;  ///< kTileSide · row + column, from the tile's north-west corner
  std::vector<double> heights;        ///< height codes
  std::vector<std::int32_t> errors;   ///< the threshold where they are not above it
  std::vector<std::uint8_t> covers;   ///< RestrictedQuadtree::covers; empty: all 15
  /// Height codes of every 64th sample of the tile, row by row. Where there is no sample, any number.
  std::array<double, static_cast<std::size_t>(kTileBlocks) * kTileBlocks> posts{};

  [[nodiscard]] std::size_t size() const { return places.size(); }
  /// Adds the vertices of a page of the tile, as decoded, that are above the threshold or for which is_needed(point)
  /// holds. The page of band 1 also has the posts.
  template <class IsNeeded>
  void take(const Page& page, const CodeDistance& distance, IsNeeded&& is_needed) {
    for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
      if (!page.is_own(p)) return take_post(page, i, p);
      const std::int32_t error = page.counted_error(i, distance);
      if (error > above || is_needed(p)) add(page, i, p, error);
    });
    if (!covers.empty()) covers.resize(places.size(), 15);
  }
  /// Adds the parents that vertices lack because their pages are not stored: with no triangle, not above, and with any
  /// height.
  void add_missing_parents(TileId id, GridRect extent);

 private:
  void take_post(const Page& page, std::size_t i, GridPoint p);
  void add(const Page& page, std::size_t i, GridPoint p, std::int32_t error);
};

/// The place of a grid point in its tile, see TileSlice.
[[nodiscard]] constexpr std::uint32_t place_in_tile(GridPoint p) {
  return static_cast<std::uint32_t>((p.row & (kTileSide - 1)) * kTileSide + (p.col & (kTileSide - 1)));
}

/// The grid point of a place; `corner` is the tile's north-west one.
[[nodiscard]] constexpr GridPoint point_at(GridPoint corner, std::uint32_t place) {
  return {corner.col + static_cast<std::int32_t>(place % kTileSide),
          corner.row + static_cast<std::int32_t>(place / kTileSide)};
}

/// Encodes and decodes slices one after the other, reusing its memory.
class SliceCoder {
 public:
  SliceCoder();
  ~SliceCoder();
  SliceCoder(SliceCoder&&) noexcept;
  SliceCoder& operator=(SliceCoder&&) noexcept;

  /// The same slice always has the same bytes, whatever the order of its vertices. A vertex that is not above the
  /// threshold is left out if a parent of it that lies in the tile and the extent is not in the slice. This happens where
  /// the border of the extent crosses pages that are not stored. The slice holds nothing if a vertex above the threshold
  /// lacks a parent, one was left out of a slice that is all, an error is above the ladder or counts as kMostEighths, or
  /// heights need more than 32 bits.
  ///
  /// cost  about 100 ns a vertex
  [[nodiscard]] std::vector<std::byte> encode(TileId id, GridRect extent, const CodeDistance& distance,
                                              const TileSlice& slice);
  /// The threshold of a slice; kNoSlice if the bytes are too short for one.
  [[nodiscard]] static std::int32_t threshold_of(std::span<const std::byte> bytes);
  /// The slice, valid until the next call. Its vertices come level by level.
  ///
  /// fails  corrupt: bytes that cannot be a slice of this tile and extent. Memory never exceeds 80 MB
  /// cost   about 40 ns a vertex, and 100 µs
  [[nodiscard]] const TileSlice& decode(TileId id, GridRect extent, const CodeDistance& distance,
                                        std::span<const std::byte> bytes);

  /// Whether the slice decoded last has the vertex of spacing 1 to 32 at this place.
  [[nodiscard]] bool has(std::uint32_t place) const;
  /// What that vertex has; it must be in that slice.
  [[nodiscard]] double height_at(std::uint32_t place) const;
  [[nodiscard]] std::int32_t error_at(std::uint32_t place) const;
  [[nodiscard]] std::uint8_t covers_at(std::uint32_t place) const;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace talus
