#include "query/verify/verify_slices.hpp"

#include <algorithm>
#include <string>
#include <unordered_map>

#include <fmt/format.h>

#include "engine/quadtree/border.hpp"
#include "engine/quadtree/extent_border.hpp"
#include "query/verify/verify_pages.hpp"

namespace talus {
namespace {

class SliceChecks {
 public:
  SliceChecks(const StoredPages& pages, DecodedPages& decoded, Findings& findings)
      : pages_(pages), decoded_(decoded), findings_(findings) {}

  void run(const CheckedPages& of_band_1) {
    const auto visit = [&](std::uint64_t position) {
      const auto page = of_band_1.find(position);
      if (page == of_band_1.end() || !page->second.entry.present) return find(page_at(1, position), "unknown");
      if (page->second.is_readable && !has_slice(page_at(1, position)))
        find(page_at(1, position), "unknown to the pages of its tile");
    };
    pages_.transaction().for_each(kSliceTable, visit, [](std::uint64_t, const Failure&) {});  // found with its pages
    for (const auto& [position, page] : of_band_1) {
      if (page.is_readable && page.entry.present && has_slice(page_at(1, position)))
        check(page_at(1, position), page.entry.generation);
    }
  }

 private:
  /// Whether a tile must have a slice: always if all samples were kept, else if its page of band 1 is in it.
  [[nodiscard]] bool has_slice(PageId tile) {
    if (keeps_all_) return true;
    const DecodedPages::Found found = decoded_.get(tile);
    return found.page && found.page->is_sliced();
  }
  /// Whether a slice has a vertex that is not above its threshold.
  [[nodiscard]] bool is_needed(GridPoint p) const {
    return keeps_all_ ? pages_.extent_border().contains(p) : is_near_border(p, pages_.manifest().description.extent);
  }

  void find(PageId tile, const std::string& what) {
    findings_.in(page_square(tile), fmt::format("slice of tile {}/{}: {}", tile.x, tile.y, what));
  }

  void check(PageId tile, std::uint32_t generation) {
    try {
      const auto stored = pages_.transaction().find({kSliceTable, curve_position(tile)});
      if (!stored) return find(tile, "missing");
      if (stored->generation != generation)
        return find(tile,
                    fmt::format("written by update {}, but its tile by update {}", stored->generation, generation));
      const Description& d = pages_.manifest().description;
      const TileSlice& slice = coder_.decode({tile.x, tile.y}, d.extent, pages_.distance(), stored->content);
      if (const std::string what = difference(tile, slice); !what.empty()) find(tile, what);
    } catch (const Failure& f) {
      if (f.cause() != Cause::corrupt) throw;
      find(tile, f.what());
    }
  }

  /// The first difference between a slice and the pages of its tile; empty if there is none.
  std::string difference(PageId tile, const TileSlice& slice) {
    if (slice.above == kNoSlice) return "";
    if (!keeps_all_ &&
        slice.above != pages_.distance().counted_within(pages_.manifest().description.kept_above().value))
      return "its threshold is not the tolerance whose vertices were kept";
    std::unordered_map<std::uint32_t, std::size_t> at;
    for (std::size_t i = 0; i < slice.size(); ++i) at.emplace(slice.places[i], i);
    const GridRect part = common(page_square(tile), pages_.manifest().description.extent);
    const auto lacks_parent = [&](GridPoint p) {
      const auto parents = diamond(p).apexes;
      return std::any_of(parents.begin(), parents.end(), [&](GridPoint parent) {
        return part.contains(parent) && spacing(parent) < kBlockSide && !at.contains(place_in_tile(parent));
      });
    };
    std::size_t found = 0;
    std::string what;
    const auto compare = [&](PageId id) {
      const DecodedPages::Found stored = decoded_.get(id);
      if (!stored.page) return;  // not stored, or already reported
      const Page& page = *stored.page;
      for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
        if (!what.empty() || !page.is_own(p)) return;
        const std::int32_t error = page.counted_error(i, pages_.distance());
        const auto here = at.find(place_in_tile(p));
        if (error <= slice.above && (!is_needed(p) || (here == at.end() && lacks_parent(p)))) return;
        ++found;
        const auto differs = [&](const char* of) {
          what = fmt::format("the {} at column {}, row {} is not that of {}", of, p.col, p.row, name_of(id));
        };
        if (here == at.end()) return differs("vertex");
        const std::size_t k = here->second;
        const int covers = page.covers.empty() ? 15 : page.covers[i];
        if (slice.errors[k] != std::max(error, slice.above)) return differs("error");
        if (slice.heights[k] != page.height(i)) return differs("height");
        if ((slice.covers.empty() ? 15 : slice.covers[k]) != covers) return differs("triangles around the vertex");
      });
    };
    compare(tile);
    for (std::size_t i = 0; i < static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross; ++i)
      compare(child_page(tile, i));
    if (!keeps_all_) found += missing_parents(tile, slice);
    if (what.empty() && found != slice.size())
      what = fmt::format("it has {} vertices, but its pages have {}", slice.size(), found);
    return what;
  }

  /// How many vertices are there only because others depend on them: their pages are not stored.
  std::size_t missing_parents(PageId tile, const TileSlice& slice) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < slice.size() && !slice.covers.empty(); ++i) {
      const GridPoint p = point_at(page_square(tile).first, slice.places[i]);
      const PageId id = page_of(p, band_of(p, pages_.manifest().bands));
      const bool is_stored = pages_.transaction().has({id.band, curve_position(id)});
      count += !is_stored && slice.errors[i] == slice.above && slice.covers[i] == 0 ? 1 : 0;
    }
    return count;
  }

  const StoredPages& pages_;
  DecodedPages& decoded_;
  Findings& findings_;
  bool keeps_all_ = pages_.manifest().description.kept_above().value == 0;
  SliceCoder coder_;
};

}  // namespace

void check_slices(const StoredPages& pages, DecodedPages& decoded, const CheckedPages& of_band_1, Findings& findings) {
  SliceChecks(pages, decoded, findings).run(of_band_1);
}

}  // namespace talus
