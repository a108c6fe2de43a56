#include "ingest/job/tile_pages.hpp"

#include <algorithm>
#include <limits>
#include <variant>

#include "engine/page/digest.hpp"
#include "engine/quadtree/border.hpp"

namespace talus {
namespace {

using Entries = std::unordered_map<std::uint64_t, ChildEntry>;

/// A slice has at most this share of the vertices of its tile.
constexpr double kShareOfSlice = 0.021;

/// If only the vertices of a tolerance are kept, a tile is a slice if that takes at most this share of the bytes of its
/// pages. Pages are read several times as fast.
constexpr double kMostOfPages = 0.9;

/// The triangles of p that leave the extent. No mesh has them. Their bits are 1, so that pages without voids store
/// none.
std::uint8_t leaving(GridRect extent, GridPoint p) {
  const std::int32_t s = spacing(p);
  if (s == kRootSpacing) return 15;
  if (p.col - s >= extent.first.col && p.col + s <= extent.last.col && p.row - s >= extent.first.row &&
      p.row + s <= extent.last.row) {
    return 0;
  }
  std::uint8_t bits = 0;
  const auto triangles = apex_triangles(p);
  for (std::size_t i = 0; i < 4; ++i) {
    if (!extent.contains(triangles[i].left) || !extent.contains(triangles[i].right))
      bits = static_cast<std::uint8_t>(bits | 1u << i);
  }
  return bits;
}

/// Sets all but heights and voids.
void begin_page(Page& page, PageId id, const PageMaking& making, bool voids) {
  page.id = id;
  page.bands = making.bands;
  page.grid = page_grid(id, making.extent);
  page.heights.resize(page.grid.size());
  page.errors.assign(page.grid.size(), 0);
  page.valid.resize(voids ? page.grid.size() : 0);
  page.covers.clear();
  page.children.clear();
}

/// Sets errors and covers of the page's own vertices by error(vertex, index) and covers(vertex, index).
/// returns  the child entry for the page above
template <class Error, class Covers>
ChildEntry complete(Page& page, const PageMaking& making, bool voids, Error&& error, Covers&& covers) {
  if (std::find(page.valid.begin(), page.valid.end(), 0) == page.valid.end()) page.valid.clear();
  ChildEntry entry = range_of(page, making.step);
  entry.present =
      entry.lowest <= entry.highest || page.id.band == making.bands - 1;  // queries start at the coarsest band
  if (voids) page.covers.assign(page.grid.size(), 0);
  bool covers_differ = false;
  const std::int32_t reach = band_spacing(page.id.band + 1);
  const auto own_spacing = static_cast<std::uint32_t>(reach) - 1;
  const GridRect square = page_square(page.id);
  const bool may_leave = !making.extent.contains({square.first.col - reach, square.first.row - reach}) ||
                         !making.extent.contains({square.last.col + reach, square.last.row + reach});
  const bool coarsest = page.id.band == making.bands - 1;
  for (std::int32_t row = 0; row < page.grid.rows; ++row) {
    for (std::int32_t col = 0; col < page.grid.cols; ++col) {
      const GridPoint p = page.grid.at(col, row);
      if (!coarsest && (static_cast<std::uint32_t>(p.col | p.row) & own_spacing) == 0)
        continue;  // belongs to a band above
      const std::size_t i = page.index(col, row);
      page.errors[i] = error(p, i);
      entry.largest = std::max(entry.largest, page.errors[i]);
      if (!voids) continue;
      const std::uint8_t with_data = covers(p, i);
      entry.present = entry.present || with_data != 0 || page.errors[i] != 0;
      page.covers[i] = static_cast<std::uint8_t>(with_data | (may_leave ? leaving(making.extent, p) : 0));
      covers_differ = covers_differ || page.covers[i] != 15;
    }
  }
  if (!covers_differ && page.valid.empty()) page.covers.clear();
  return entry;
}

void with_children(Page& page, ChildEntry& entry, const Entries& below) {
  page.children.resize(static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross);
  for (std::size_t i = 0; i < page.children.size(); ++i) {
    const auto found = below.find(curve_position(child_page(page.id, i)));
    if (found == below.end() || !found->second.present) continue;
    page.children[i] = found->second;
    entry = joined(entry, found->second);
  }
}

PageBytes bytes_of(PageEncoder& encoder, const Page& page, ChildEntry& entry, const PageMaking& making) {
  PageBytes made{{page.id.band, curve_position(page.id)}, encoder.encode(page, making.distance, page.id.band == 0), 0};
  made.generation = making.generation(made.key, made.content);
  entry.generation = made.generation;
  return made;
}

std::size_t bytes_in(const std::vector<PageBytes>& pages) {
  std::size_t bytes = 0;
  for (const PageBytes& page : pages) bytes += page.content.size();
  return bytes;
}

struct ValidRange {
  std::uint64_t samples;
  double lowest, highest;  // lowest > highest: no valid sample
};
ValidRange valid_range(const Page& page) {
  std::uint64_t samples = 0;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::size_t i = 0; i < page.heights.size(); ++i) {
    if (!page.valid.empty() && !page.valid[i]) continue;
    const double h = page.heights[i];
    ++samples;
    lowest = h < lowest ? h : lowest;
    highest = h > highest ? h : highest;
  }
  return {samples, lowest, highest};
}

/// Counts by error code, and then the counts above each rung.
class Histogram {
 public:
  /// Counts a page of band 0 or 1, which is never the coarsest.
  void count(const Page& page) {
    const auto own_spacing = static_cast<std::uint32_t>(band_spacing(page.id.band + 1)) - 1;
    for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
      const bool is_own = (static_cast<std::uint32_t>(p.col | p.row) & own_spacing) != 0;
      by_code_[page.errors[i]] += is_own ? 1 : 0;
    });
  }
  [[nodiscard]] ErrorHistogram above_rungs() const {
    ErrorHistogram above{};
    for (std::size_t rung = 0; rung < kErrorRungs; ++rung) {
      for (std::size_t code = largest_code_within(error_rung(rung)) + 1u; code < by_code_.size(); ++code)
        above[rung] += by_code_[code];
    }
    return above;
  }

 private:
  std::vector<std::uint32_t> by_code_ = std::vector<std::uint32_t>(kAlwaysSelected + 1u);
};

/// Copies every `step`-th value of a row.
template <class From, class To>
void copy_every(const From* from, std::size_t count, std::size_t step, To* to) {
  if (step == 1) {
    for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<To>(from[i]);
  } else {
    for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<To>(from[i * step]);
  }
}

class TilePacker {
 public:
  TilePacker(TileId id, const TileErrors& tile, std::span<const std::uint8_t> valid, const PageMaking& making,
             TilePacking& memory)
      : id_(id), tile_(tile), valid_(valid), making_(making), memory_(memory), page_(memory.page) {}

  TilePages run() {
    if (tile_.all_void) {
      hold_voids();
      return std::move(made_);
    }
    made_.summary.record = tile_.record;
    const PageId parent{1, id_.x, id_.y};
    Entries below;
    // The children of a page are 64 consecutive positions of the curve.
    std::vector<PageId> children;
    for (std::size_t i = 0; i < static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross; ++i)
      children.push_back(child_page(parent, i));
    std::sort(children.begin(), children.end(),
              [](PageId a, PageId b) { return curve_position(a) < curve_position(b); });
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const PageId id : children) {
      if (page_grid(id, making_.extent).size() == 0 || is_far_from_data(id)) continue;
      const Page& page = begin(id);
      const auto [valid, low, high] = valid_range(page);
      made_.summary.valid_samples += valid;
      lowest = std::min(lowest, low);
      highest = std::max(highest, high);
      ChildEntry entry = finish();
      if (!entry.present) continue;
      histogram_.count(page);
      made_.pages.push_back(bytes_of(memory_.encoder, page, entry, making_));
      below.emplace(curve_position(id), entry);
      largest_.emplace(curve_position(id), entry.largest);
    }
    if (made_.summary.valid_samples > 0) {
      const double a = making_.step.value(lowest), b = making_.step.value(highest);
      made_.summary.lowest = std::min(a, b);  // a negative scale swaps them
      made_.summary.highest = std::max(a, b);
    }
    const Page& page = begin(parent);
    ChildEntry entry = finish();
    with_children(page_, entry, below);
    entry.present = entry.present || !below.empty();
    if (entry.present) {
      histogram_.count(page);
      made_.pages.push_back(bytes_of(memory_.encoder, page, entry, making_));
    }
    made_.summary.entry = entry;
    made_.summary.errors = histogram_.above_rungs();
    keep_posts(page);
    if (entry.present) making_.kept_above == 0 ? make_slice(entry.generation) : keep_in_slice();
    return std::move(made_);
  }

 private:
  /// The record of a tile without data: all halves inside the extent are void, and no vertex has a fill.
  void hold_voids() {
    TileRecord& record = made_.summary.record;
    const GridPoint corner{id_.x * kTileSide, id_.y * kTileSide};
    const GridRect tile{corner, {corner.col + kTileSide, corner.row + kTileSide}};
    const auto voids_of = [&](GridPoint p) {
      std::uint8_t holds = 0;
      for (const int side : {0, 1}) {
        const HalfDiamond t = half_diamond(p, side);
        if (inside(t, tile) && inside(t, making_.extent)) holds |= static_cast<std::uint8_t>(kVoid << (2 * side));
      }
      return holds;
    };
    for (std::int32_t y = 0; y < kTileBlocks; ++y) {
      for (std::int32_t x = 0; x < kTileBlocks; ++x) {
        record.blocks[static_cast<std::size_t>(y * kTileBlocks + x)].holds =
            voids_of({corner.col + x * kBlockSide + kBlockSide / 2, corner.row + y * kBlockSide + kBlockSide / 2});
      }
    }
    for (std::int32_t y = 0; y < TileRecord::kAcross; ++y) {
      for (std::int32_t x = 0; x < TileRecord::kAcross; ++x) {
        const GridPoint p{corner.col + x * kBlockSide, corner.row + y * kBlockSide};
        if (!making_.extent.contains(p)) continue;
        std::uint8_t& holds = record.holds[static_cast<std::size_t>(y * TileRecord::kAcross + x)];
        holds = TileRecord::kNoFill;
        if (spacing(p) < kTileSide) holds |= voids_of(p);
      }
    }
  }

  /// Begins a page and copies its samples.
  const Page& begin(PageId id) {
    Page& page = page_;
    begin_page(page, id, making_, !valid_.empty());
    const std::size_t step = std::size_t{1} << page.grid.shift;
    if (page.grid.size() == 0) return page;
    std::visit(
        [&](const auto& codes) {
          for (std::int32_t row = 0; row < page.grid.rows; ++row) {
            const std::size_t from = index(page.grid.at(0, row)), to = page.index(0, row);
            const auto cols = static_cast<std::size_t>(page.grid.cols);
            copy_every(&codes[from], cols, step, &page.heights[to]);
            if (!valid_.empty()) copy_every(&valid_[from], cols, step, &page.valid[to]);
          }
        },
        tile_.heights);
    return page;
  }

  /// Whether the page's square, or `reach` cells around it, has a sample with this mask value (1: valid, 0: void).
  [[nodiscard]] bool has_near(PageId id, std::int32_t reach, std::uint8_t data) const {
    const GridRect near = common(grown(page_square(id), reach), window_);
    for (std::int32_t row = near.first.row; row <= near.last.row; ++row) {
      const auto start = valid_.begin() + static_cast<std::ptrdiff_t>(index({near.first.col, row}));
      const auto end = start + near.cols();
      if (std::find(start, end, data) != end) return true;
    }
    return false;
  }
  /// Triangles at own vertices reach as far as twice their largest spacing.
  [[nodiscard]] bool has_voids_near(PageId id) const {
    return tile_.voids.has_value() && has_near(id, band_spacing(id.band + 1), 0);
  }
  /// A vertex of band 0 depends on samples less than three spacings away.
  [[nodiscard]] bool is_far_from_data(PageId id) const {
    return !valid_.empty() && !has_near(id, 2 * band_spacing(1), 1);
  }

  [[nodiscard]] ChildEntry finish() {
    const bool voids = has_voids_near(page_.id);
    copy_errors();
    return complete(
        page_, making_, voids, [&](GridPoint, std::size_t i) { return page_.errors[i]; },
        [&](GridPoint p, std::size_t) { return tile_.voids->apex_triangles_with_data(p); });
  }

  /// Copies errors level by level. A level has zeros at coarser vertices, so coarser levels come later.
  void copy_errors() {
    const PageGrid& grid = page_.grid;
    for (int shift = grid.shift; shift < grid.shift + kBandLevels; ++shift) {
      const auto level = tile_.errors.units(shift);
      const int finer = shift - grid.shift;  // log2 of the level's step on the page's grid
      const std::int32_t step = 1 << finer;
      const GridPoint first{(grid.first.col + step - 1) >> finer, (grid.first.row + step - 1) >> finer};
      const GridPoint last{(grid.first.col + grid.cols - 1) >> finer, (grid.first.row + grid.rows - 1) >> finer};
      if (first.col > last.col) continue;
      for (std::int32_t row = first.row; row <= last.row; ++row) {
        const ErrorCode* from = &level.at(first.col, row);
        ErrorCode* to = &page_.errors[page_.index(first.col * step - grid.first.col, row * step - grid.first.row)];
        for (std::int32_t i = 0; i <= last.col - first.col; ++i) to[i * step] = from[i];
      }
    }
  }

  /// Slices the finest threshold of 1, 2, 5 a decade that leaves few vertices above it. A page that has none of them
  /// is not looked into.
  void make_slice(std::uint32_t generation) {
    const auto most = static_cast<std::uint64_t>(kShareOfSlice * static_cast<double>(made_.summary.valid_samples));
    std::size_t rung = 0;
    while (rung + 1 < kErrorRungs && made_.summary.errors[rung] > most) ++rung;
    const CodeDistance& distance = making_.distance;
    TileSlice slice;
    slice.above = made_.summary.errors[rung] > most ? kNoSlice : distance.counted_within(error_rung(rung));
    for (const PageBytes& page : made_.pages) {
      if (slice.above == kNoSlice) break;
      const PageId id = page_at(page.key.table, page.key.position);
      const bool is_beside_border = making_.border->is_near(page_square(id));
      if (id.band > 0 || is_beside_border || distance.counted(largest_.at(page.key.position)) > slice.above) {
        slice.take(decoded(page), distance,
                   [&](GridPoint p) { return is_beside_border && making_.border->contains(p); });
      }
    }
    put_slice(slice, generation);
  }

  /// Replaces the pages by a slice of the vertices that are kept, if that takes fewer bytes. The pages are left with their
  /// voids and child entries.
  void keep_in_slice() {
    TileSlice slice;
    slice.above = making_.distance.counted_within(making_.kept_above);
    slice.is_all = true;
    std::vector<Page> left;
    std::unordered_map<std::uint64_t, ErrorCode> largest;  // of what is kept in each page of band 0
    ErrorCode most = 0;                                    // in the last page and below it
    for (const PageBytes& bytes : made_.pages) {
      const Page& page = decoded(bytes);
      slice.take(page, making_.distance, [&](GridPoint p) { return is_near_border(p, making_.extent); });
      left.push_back(without_heights(page));
      most = keep_largest(left.back(), page, slice.above, largest);
      if (page.id.band == 0) largest.emplace(bytes.key.position, most);
    }
    slice.add_missing_parents(id_, making_.extent);
    put_slice(slice, 0);
    const std::vector<std::byte>& content = made_.slice->content;
    if (SliceCoder::threshold_of(content) == kNoSlice ||
        static_cast<double>(content.size()) > kMostOfPages * static_cast<double>(bytes_in(made_.pages))) {
      made_.slice.reset();
      return;
    }
    const std::uint64_t digest = digest_of(content);
    for (std::size_t i = 0; i < left.size(); ++i)
      made_.pages[i].content = memory_.encoder.encode_in_slice(left[i], digest);
    made_.summary.entry.largest = most;  // the last page is that of band 1
  }

  /// What is left of a page that is in a slice.
  [[nodiscard]] static Page without_heights(const Page& page) {
    Page left;
    left.id = page.id, left.bands = page.bands, left.grid = page.grid;
    left.valid = page.valid, left.covers = page.covers, left.children = page.children;
    return left;
  }
  /// Sets the largest errors of child pages to those that are kept, and returns that of the page and all below it.
  ErrorCode keep_largest(Page& left, const Page& page, std::int32_t above,
                         const std::unordered_map<std::uint64_t, ErrorCode>& of_children) const {
    ErrorCode most = 0;
    for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
      if (page.is_own(p)) most = std::max(most, page.error(i, making_.distance));
    });
    if (most <= above) most = 0;
    for (std::size_t i = 0; i < left.children.size(); ++i) {
      ChildEntry& child = left.children[i];
      if (child.present) child.largest = of_children.at(curve_position(child_page(page.id, i)));
      most = std::max(most, child.largest);
    }
    return most;
  }

  void put_slice(const TileSlice& slice, std::uint32_t generation) {
    made_.slice = PageBytes{{kSliceTable, curve_position({1, id_.x, id_.y})},
                            memory_.slices.encode(id_, making_.extent, making_.distance, slice),
                            generation};
  }

  /// A page as it was made. The last one is that of band 1.
  const Page& decoded(const PageBytes& page) {
    return memory_.decoder.decode(
        page_at(page.key.table, page.key.position), making_.extent, making_.bands, making_.distance, page.content,
        [&](PageId, PageDecoder::Content) { return std::span<const std::byte>(made_.pages.back().content); });
  }

  /// Keeps every 64th sample. The page of band 1 has every 8th.
  void keep_posts(const Page& page) {
    constexpr std::int32_t kStep = kBlockSide >> band_shift(1);
    for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
      const std::int32_t x = (p.col >> page.grid.shift) & (kPageSide - 1);
      const std::int32_t y = (p.row >> page.grid.shift) & (kPageSide - 1);
      if (x % kStep != 0 || y % kStep != 0) return;
      const auto post = static_cast<std::size_t>(y / kStep * kTileBlocks + x / kStep);
      made_.summary.posts[post] = page.heights[i];
      made_.summary.post_valid[post] = page.is_data(i) ? 1 : 0;
    });
  }

  [[nodiscard]] std::size_t index(GridPoint p) const { return index_in(window_, p); }

  TileId id_;
  const TileErrors& tile_;
  std::span<const std::uint8_t> valid_;
  const PageMaking& making_;
  GridRect window_ = tile_window(id_, making_.extent);
  TilePages made_;
  std::unordered_map<std::uint64_t, ErrorCode> largest_;  ///< of each page of band 0
  Histogram histogram_;
  TilePacking& memory_;
  Page& page_;
};

}  // namespace

TilePages pack_tile(TileId id, const TileErrors& tile, std::span<const std::uint8_t> valid, const PageMaking& making,
                    TilePacking& memory) {
  return TilePacker(id, tile, valid, making, memory).run();
}

void pack_coarse(const CoarseLevels& levels, Entries entries, const PageMaking& making,
                 const std::function<void(PageBytes)>& take) {
  const bool voids = levels.has_voids();
  PageEncoder encoder;
  Page page;
  for (int band = kFewestBands - 1; band < making.bands; ++band) {
    Entries above;
    for (const PageId id : pages_of_band(band, making.extent)) {
      begin_page(page, id, making, voids);
      for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
        page.heights[i] = levels.height(p);
        if (voids) page.valid[i] = levels.is_valid(p) ? 1 : 0;
      });
      ChildEntry entry = complete(
          page, making, voids, [&](GridPoint p, std::size_t) { return levels.error(p); },
          [&](GridPoint p, std::size_t) {
            return height_in_tree(p) >= levels.root_height() ? std::uint8_t{15} : levels.apex_triangles_with_data(p);
          });
      with_children(page, entry, entries);
      entry.present = entry.present || std::any_of(page.children.begin(), page.children.end(),
                                                   [](const ChildEntry& child) { return child.present; });
      if (!entry.present) continue;
      take(bytes_of(encoder, page, entry, making));
      above.emplace(curve_position(id), entry);
    }
    entries = std::move(above);
  }
}

}  // namespace talus
