#pragma once
// From settled errors to the bytes of pages.

#include <functional>
#include <unordered_map>
#include <vector>

#include "engine/tile/coarse_levels.hpp"
#include "engine/tile/tile_summary.hpp"
#include "storage/page_store.hpp"

namespace talus {

/// What all pages of a database have in common.
struct PageMaking {
  GridRect extent;
  HeightStep step;
  CodeDistance distance;
  int bands = kFewestBands;
  double kept_above = 0;  ///< see Description
  /// The generation a page is stored with: that of the page it replaces if the bytes are the same.
  std::function<std::uint32_t(PageKey, std::span<const std::byte>)> generation;
};

struct PageBytes {
  PageKey key;
  std::vector<std::byte> content;
  std::uint32_t generation = 0;
};

struct TilePages {
  std::vector<PageBytes> pages;  ///< band 0 in curve order, then the page of band 1; none where there is no data
  TileSummary summary;
};

/// What packing works in, to be used again. No result depends on what it holds.
struct TilePacking {
  PageEncoder encoder;
  Page page;
};

/// The pages and the summary of a tile; `valid` over its window, empty: all data. About 30 ns a sample.
[[nodiscard]] TilePages pack_tile(TileId id, const TileErrors& tile, std::span<const std::uint8_t> valid,
                                  const PageMaking& making, TilePacking& memory);

/// Hands out the pages of bands 2 and above, each after those below it. `entries`: of the pages of band 1, by position
/// on the curve.
void pack_coarse(const CoarseLevels& levels, std::unordered_map<std::uint64_t, ChildEntry> entries,
                 const PageMaking& making, const std::function<void(PageBytes)>& take);

}  // namespace talus
