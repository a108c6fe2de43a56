#pragma once
// Makes the bytes of pages from errors.

#include <functional>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "engine/page/tile_slice.hpp"
#include "engine/quadtree/extent_border.hpp"
#include "engine/tile/coarse_levels.hpp"
#include "engine/tile/tile_summary.hpp"
#include "storage/page_store.hpp"

namespace talus {

/// Facts that all pages of a database share.
struct PageMaking {
  GridRect extent;
  HeightStep step;
  CodeDistance distance;
  int bands = kFewestBands;
  double kept_above = 0;                       ///< Description::kept_above
  std::shared_ptr<const ExtentBorder> border;  ///< of the extent
  /// The generation of a page: that of the page it replaces if the bytes are the same.
  std::function<std::uint32_t(PageKey, std::span<const std::byte>)> generation;
};

struct PageBytes {
  PageKey key;
  std::vector<std::byte> content;
  std::uint32_t generation = 0;
};

struct TilePages {
  std::vector<PageBytes> pages;  ///< band 0 in curve order, then the page of band 1; no page without data
  /// The slice of a tile that has a page of band 1. If not all samples are kept: none, or the pages are in it.
  std::optional<PageBytes> slice;
  TileSummary summary;
};

/// Memory for packing, used again for each tile. Results do not depend on its content.
struct TilePacking {
  PageEncoder encoder;
  PageDecoder decoder;
  SliceCoder slices;
  Page page;
};

/// The pages and the summary of a tile. `valid`: mask of its window; empty if all are valid. About 30 ns a sample.
[[nodiscard]] TilePages pack_tile(TileId id, const TileErrors& tile, std::span<const std::uint8_t> valid,
                                  const PageMaking& making, TilePacking& memory);

/// Passes on the pages of bands 2 and above, finer bands first. `entries`: child entries of band 1 by curve position.
void pack_coarse(const CoarseLevels& levels, std::unordered_map<std::uint64_t, ChildEntry> entries,
                 const PageMaking& making, const std::function<void(PageBytes)>& take);

}  // namespace talus
